// The only file that includes Valijson, which takes the compiler 10 s.
#include "common/experiment/testing/schema_validator.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "common/experiment/schema.hpp"

namespace aloft::experiment {
namespace {

/// "<root>[worlds][0][file]" -> "worlds[0].file"
std::string json_path(const std::string& context) {
  std::string path;
  for (std::size_t open = context.find('['); open != std::string::npos; open = context.find('[', open + 1)) {
    const std::string key = context.substr(open + 1, context.find(']', open) - open - 1);
    const bool index = !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
    path += index ? fmt::format("[{}]", key) : (path.empty() ? "" : ".") + key;
  }
  return path.empty() ? "the file" : path;
}

/// Changes numbers so that Valijson judges them as JSON Schema does: it does not accept 5.0 as an integer, and reads
/// whole numbers from 2^63 as negative.
void make_readable(nlohmann::json& value) {
  if (value.is_structured()) {
    for (nlohmann::json& part : value) make_readable(part);
  } else if (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) {
    value = value.get<double>();
  } else if (value.is_number_float()) {
    const auto x = value.get<double>();
    if (std::fabs(x) < 0x1p63 && x == std::floor(x)) value = static_cast<std::int64_t>(x);
  }
}

const valijson::Schema& parsed_schema() {
  static const auto schema = [] {
    auto parsed = std::make_unique<valijson::Schema>();
    const nlohmann::json text = experiment_schema();
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), *parsed);
    return parsed;
  }();
  return *schema;
}

}  // namespace

std::vector<std::string> schema_errors(const nlohmann::json& document) {
  nlohmann::json readable = document;
  // Halved, because a seed can have all 64 bits and must stay an integer below 2^63 here.
  if (readable.is_object() && readable.contains("seed") && readable["seed"].is_number_unsigned())
    readable["seed"] = readable["seed"].get<std::uint64_t>() >> 1U;
  make_readable(readable);
  valijson::Validator validator;
  valijson::ValidationResults results;
  validator.validate(parsed_schema(), valijson::adapters::NlohmannJsonAdapter(readable), &results);
  std::vector<std::string> errors;
  for (const auto& error : results) {
    // Such an error says only that a part of the schema failed; the errors of that part are listed, too.
    if (error.description.find("associated with") != std::string::npos) continue;
    std::string context;
    for (const std::string& part : error.context) context += part;
    errors.push_back(fmt::format("{}: {}", json_path(context), error.description));
  }
  if (errors.empty() && results.numErrors() > 0) errors.emplace_back("the file does not fit the schema of experiments");
  return errors;
}

}  // namespace aloft::experiment
