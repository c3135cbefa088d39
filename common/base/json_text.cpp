#include "common/base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/plain_text.hpp"

namespace aloft {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t longest_key_shown = 80;

/// "line L, column C" of the text's `byte`-th byte; all three count from 1.
std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte == 0 ? 0 : byte - 1, text.size()));
  const auto line = std::ranges::count(before, '\n') + 1;
  const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return fmt::format("line {}, column {}", line, before.size() - line_start + 1);
}

/// The library's message without its number and position.
std::string reason(std::string_view message) {
  const std::size_t position = message.find("column ");
  const std::size_t start = position == std::string_view::npos ? message.find("] ") : message.find(": ", position);
  return std::string(start == std::string_view::npos ? message : message.substr(start + 2));
}

/// Iterates over a text and counts the bytes read: the parser does not report its position to its callback.
class Cursor {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Cursor(const char* at, std::size_t& bytes_read) : at_(at), bytes_read_(&bytes_read) {}
  reference operator*() const noexcept { return *at_; }
  Cursor& operator++() noexcept {
    ++at_;
    ++*bytes_read_;
    return *this;
  }
  bool operator==(const Cursor& other) const noexcept { return at_ == other.at_; }

 private:
  const char* at_;
  std::size_t* bytes_read_;
};

/// Checks the text while it is parsed: the finished value has only the last of two equal keys, and a value that is
/// nested too deep could not even be destroyed safely. Makes -0.0 the 0.0 that it equals.
class Watch {
 public:
  Watch(std::string_view text, std::string_view where, const std::size_t& bytes_read)
      : text_(text), where_(where), bytes_read_(bytes_read) {}

  bool operator()(int depth, OrderedJson::parse_event_t event, OrderedJson& parsed) {
    using Event = OrderedJson::parse_event_t;
    if ((event == Event::object_start || event == Event::array_start) &&
        std::cmp_greater_equal(depth, limits::json_depth))
      refuse(fmt::format("lists and objects are nested more than {} deep", limits::json_depth));
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(parsed.get<std::string>()).second)
      refuse(
          fmt::format("the key {} stands twice in one object; keep one", plain_text(parsed.dump(), longest_key_shown)));
    if (event == Event::value && parsed.is_number_float() && parsed == 0.0) parsed = 0.0;
    return true;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError("{}: {}: {}", where_, line_and_column(text_, bytes_read_), why);
  }

  std::string_view text_;
  std::string_view where_;
  const std::size_t& bytes_read_;
  std::vector<std::set<std::string>> open_;
};

}  // namespace

OrderedJson parse_json(std::string_view text, std::string_view where) {
  if (text.size() > limits::json_bytes)
    throw InputError("{}: has {} bytes; JSON of at most {} is read", where, text.size(), limits::json_bytes);
  std::size_t bytes_read = 0;
  try {
    return OrderedJson::parse(Cursor(text.data(), bytes_read), Cursor(text.data() + text.size(), bytes_read),
                              Watch(text, where, bytes_read));
  } catch (const OrderedJson::parse_error& error) {
    throw InputError("{}: {}: not valid JSON: {}", where, line_and_column(text, error.byte),
                     excerpt(reason(error.what())));
  } catch (const OrderedJson::exception& error) {
    throw InputError("{}: not valid JSON: {}", where, excerpt(reason(error.what())));
  }
}

}  // namespace aloft
