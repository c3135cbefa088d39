#include "common/experiment/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace aloft::experiment {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return fmt::format("line {}, column {}", line, before.size() - line_start + 1);
}

/// The library's message without its number and position.
std::string reason(std::string_view message) {
  const std::size_t position = message.find("column ");
  const std::size_t start = position == std::string_view::npos ? message.find("] ") : message.find(": ", position);
  return std::string(start == std::string_view::npos ? message : message.substr(start + 2));
}

/// Sees every key while the text is read: in the finished value only the last of two equal keys is left.
class KeyWatch {
 public:
  explicit KeyWatch(std::string_view where) : where_(where) {}

  bool operator()(int /*depth*/, OrderedJson::parse_event_t event, OrderedJson& parsed) {
    using Event = OrderedJson::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(parsed.get<std::string>()).second)
      throw InputError(fmt::format("{}: the key {} stands twice in one object; keep one", where_, parsed.dump()));
    return true;
  }

 private:
  std::string_view where_;
  std::vector<std::set<std::string>> open_;
};

}  // namespace

OrderedJson parse_json(std::string_view text, std::string_view where) {
  try {
    return OrderedJson::parse(text.begin(), text.end(), KeyWatch(where));
  } catch (const OrderedJson::parse_error& error) {
    throw InputError(
        fmt::format("{}: {}: not valid JSON: {}", where, line_and_column(text, error.byte), reason(error.what())));
  } catch (const OrderedJson::exception& error) {
    throw InputError(fmt::format("{}: not valid JSON: {}", where, reason(error.what())));
  }
}

}  // namespace aloft::experiment
