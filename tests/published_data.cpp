#include "tests/published_data.hpp"

#include "tests/paths.hpp"
#include "tests/skip.hpp"

namespace aloft::test {

std::filesystem::path published_file(const std::string& name) {
  const std::filesystem::path file = (source_dir() / "../shared/data" / name).lexically_normal();
  if (std::filesystem::exists(file)) return file;
  skip("there is no " + file.string());
  return {};
}

}  // namespace aloft::test
