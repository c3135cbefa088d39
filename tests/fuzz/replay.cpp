// In ordinary builds, in place of libFuzzer: runs the target on the files given, and on all files of the folders given.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "common/base/read_file.hpp"
#include "tests/fuzz/target.hpp"

namespace fs = std::filesystem;

int main(int count, char** arguments) {
  std::vector<fs::path> files;
  for (const char* const* argument = arguments + 1; argument < arguments + count; ++argument) {
    const fs::path place(*argument);
    if (!fs::is_directory(place))
      files.push_back(place);
    else
      for (const fs::directory_entry& entry : fs::directory_iterator(place)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::printf("%s\n", file.c_str());  // the last line names the input of a crash
    std::fflush(stdout);
    const std::string input = aloft::read_file(file);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  }
  std::printf("%zu inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
