#include "common/experiment/world_parameters.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/experiment/file_paths.hpp"
#include "common/world/measured_flight.hpp"

namespace aloft::experiment {

std::span<const ParameterSpec> measured_world_parameters() {
  static const std::vector<ParameterSpec> table{
      text_parameter(
          "file", "",
          "Path of the CSV file with the measured flight; a relative one counts from the experiment file's folder."),
      text_parameter("file_sha256", "", "SHA-256 that the file must have; filled in when an experiment is resolved."),
  };
  return table;
}

Parameters resolve_measured_world(const nlohmann::json& given, std::string_view where, const FileAccess& files) {
  const Parameters checked(measured_world_parameters(), given, where);
  const std::string& expected = checked.text("file_sha256");
  if (checked.text("file").empty())
    throw InputError("{}.file: missing; give the path of a CSV file with the measured flight", where);
  nlohmann::json resolved{{"file", std::filesystem::absolute(checked.text("file")).lexically_normal().string()},
                          {"file_sha256", expected}};
  if (files.always_read || expected.empty()) {
    try {
      const std::filesystem::path file = locate(checked.text("file"));
      const std::string csv = read_file(file);
      check_unchanged(file, csv, expected, "use the original file, or remove file_sha256 to take this one");
      (void)world::parse_measured_flight(csv, file.string());
      resolved["file_sha256"] = sha256_hex(csv);
    } catch (const InputError& error) {
      throw InputError("{}.file: {}", where, error.what());
    }
  }
  return Parameters(measured_world_parameters(), resolved, where);
}

}  // namespace aloft::experiment
