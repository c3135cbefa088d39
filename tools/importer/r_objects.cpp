#include "tools/importer/r_objects.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace aloft::importer {
namespace {

constexpr int largest_depth = 100;                    // of lists in lists; a list's own length is no depth
constexpr std::size_t largest_sequences = 1'000'000;  // elements of all sequences that the file only describes

/// Types of objects in a workspace, in R's numbers.
enum Type : std::uint32_t {
  symbol = 1,
  pair_list = 2,
  closure = 3,
  environment = 4,
  promise = 5,
  call = 6,
  special_function = 7,
  builtin_function = 8,
  text = 9,
  logicals = 10,
  integers = 13,
  reals = 14,
  complex_numbers = 15,
  texts = 16,
  dots = 17,
  list = 19,
  expressions = 20,
  external_pointer = 22,
  weak_reference = 23,
  raw_bytes = 24,
  s4_object = 25,
  alternative = 238,  // a vector in another form, such as 1:10
  base_environment = 241,
  empty_environment = 242,
  persistent = 247,
  package = 248,
  name_space = 249,
  base_name_space = 250,
  missing_argument = 251,
  unbound = 252,
  global_environment = 253,
  null = 254,
  reference = 255,
};

/// The word before each object.
struct Head {
  std::uint32_t word = 0;

  [[nodiscard]] std::uint32_t type() const { return word & 0xFFU; }
  [[nodiscard]] bool has_attributes() const { return (word & 0x200U) != 0; }
  [[nodiscard]] bool has_tag() const { return (word & 0x400U) != 0; }
  [[nodiscard]] bool is_pair() const {
    return type() == pair_list || type() == closure || type() == promise || type() == call || type() == dots;
  }
};

class ObjectReader {
 public:
  explicit ObjectReader(std::string_view bytes) : bytes_(bytes) {}

  NumericVectors read() {
    constexpr std::size_t magic_bytes = 7;  // "RDX3\nX\n"
    constexpr std::size_t words_of_versions = 2;
    skip_bytes(magic_bytes);
    const std::uint32_t version = word();
    if (version != 2 && version != 3) fail(fmt::format("format version {}, known are 2 and 3", version));
    skip_bytes(words_of_versions * sizeof(std::uint32_t));
    if (version == 3) skip_bytes(word());  // the name of the encoding
    NumericVectors vectors;
    Head at = head();
    for (; at.type() == pair_list; at = head()) {
      if (at.has_attributes()) skip(1);
      const std::string name = at.has_tag() ? symbol_name() : "";
      if (std::vector<double> values; vector(head(), values)) vectors[name] = std::move(values);
    }
    if (at.type() != null) fail("the objects are no list");
    if (position_ != bytes_.size()) fail("the objects end before the file");
    return vectors;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw UnreadableObjects(fmt::format("near byte {}: {}", position_, why));
  }

  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size() - position_) fail("cut short");
    position_ += size;
    return bytes_.substr(position_ - size, size);
  }
  void skip_bytes(std::uint64_t size) { static_cast<void>(take(size)); }

  template <class Number, class Bits>
  Number number() {
    Bits bits = 0;
    for (const char byte : take(sizeof(Bits))) bits = bits << 8U | static_cast<unsigned char>(byte);
    return std::bit_cast<Number>(bits);
  }
  std::uint32_t word() { return number<std::uint32_t, std::uint32_t>(); }
  double real() { return number<double, std::uint64_t>(); }
  /// NA is the lowest integer.
  double integer() {
    const auto value = number<std::int32_t, std::uint32_t>();
    return value == std::numeric_limits<std::int32_t>::min() ? std::numeric_limits<double>::quiet_NaN() : value;
  }
  Head head() { return {word()}; }

  /// A number of elements of at least `least_bytes` each.
  std::uint32_t count(std::uint32_t least_bytes) {
    const std::uint32_t elements = word();
    if (std::uint64_t{elements} * least_bytes > bytes_.size() - position_)
      fail(fmt::format("{} elements, but only {} bytes follow", elements, bytes_.size() - position_));
    return elements;
  }

  /// A text without its head; NA is empty.
  std::string_view text_after_head() {
    const std::uint32_t size = word();
    return size == ~0U ? std::string_view{} : take(size);
  }

  /// A symbol or a reference to an earlier one; what else references point to has no name.
  std::string symbol_name() {
    const Head at = head();
    if (at.type() == symbol) return new_symbol();
    if (at.type() != reference) fail("a name is no symbol");
    const std::uint32_t index = referred(at);
    if (index == 0 || index > referable_.size()) fail("a reference to nothing");
    return referable_[index - 1];
  }
  std::string new_symbol() {
    if (head().type() != text) fail("a symbol has no name");
    return referable_.emplace_back(text_after_head());
  }
  std::uint32_t referred(const Head& at) {
    const std::uint32_t packed = at.word >> 8U;
    return packed != 0 ? packed : word();
  }

  /// Reads an object; true, with its values, if it is a vector of numbers.
  bool vector(const Head& at, std::vector<double>& values) {
    if (at.type() == alternative) return alternative_vector(values);
    if (at.type() != reals && at.type() != integers) {
      skip(at, 1);
      return false;
    }
    const bool whole = at.type() == integers;
    values.resize(count(whole ? sizeof(std::int32_t) : sizeof(double)));
    for (double& value : values) value = whole ? integer() : real();
    if (at.has_attributes()) skip(1);
    return true;
  }

  /// Class, package and type in a list; the content; attributes.
  bool alternative_vector(std::vector<double>& values) {
    const Head about = head();
    if (about.type() != pair_list || about.has_attributes() || about.has_tag()) fail("a vector of an unknown form");
    const std::string name = symbol_name();
    skip(1);
    bool numbers = false;
    const Head content = head();
    if (name == "compact_intseq" || name == "compact_realseq") {
      sequence(content, values);
      numbers = true;
    } else if ((name == "wrap_real" || name == "wrap_integer") && content.type() == pair_list && !content.has_tag() &&
               !content.has_attributes()) {
      const Head wrapped = head();
      if (wrapped.type() == alternative) fail("a vector in another form twice");
      numbers = vector(wrapped, values);
      skip(1);
    } else {
      skip(content, 1);
    }
    skip(1);
    return numbers;
  }

  /// Length, first value and difference.
  void sequence(const Head& at, std::vector<double>& values) {
    if (at.type() != reals || at.has_attributes() || word() != 3) fail("a sequence that is none");
    const double length = real();
    double value = real();
    const double difference = real();
    if (!(length >= 0.0 && length <= static_cast<double>(largest_sequences - described_)))
      fail("a sequence of an impossible length");
    values.resize(static_cast<std::size_t>(length));
    described_ += values.size();
    for (double& next : values) {
      next = value;
      value += difference;
    }
  }

  void skip(int depth) { skip(head(), depth); }

  void skip(Head at, int depth) {
    if (depth > largest_depth) fail(fmt::format("objects within each other more than {} deep", largest_depth));
    for (; at.is_pair(); at = head()) {
      if (at.has_attributes()) skip(depth + 1);
      if (at.has_tag()) skip(depth + 1);
      skip(depth + 1);
    }
    if (!skip_plain(at)) skip_nested(at, depth);
  }

  /// Objects that hold no others, other than texts and attributes.
  bool skip_plain(const Head& at) {
    switch (at.type()) {
      case null:
      case global_environment:
      case unbound:
      case missing_argument:
      case base_name_space:
      case empty_environment:
      case base_environment:
        return true;
      case reference:
        static_cast<void>(referred(at));
        return true;
      case symbol:
        static_cast<void>(new_symbol());
        return true;
      case text:
      case special_function:
      case builtin_function:
        static_cast<void>(text_after_head());
        return true;
      case persistent:
      case package:
      case name_space:
        skip_bytes(sizeof(std::uint32_t));
        skip_texts();
        referable_.emplace_back();
        return true;
      default:
        return false;
    }
  }

  void skip_texts() {
    for (std::uint32_t left = count(2 * sizeof(std::uint32_t)); left > 0; --left) {
      if (head().type() != text) fail("a list of texts holds something else");
      static_cast<void>(text_after_head());
    }
  }

  void skip_nested(const Head& at, int depth) {
    int parts = at.has_attributes() ? 1 : 0;
    switch (at.type()) {
      case logicals:
      case integers:
        skip_bytes(sizeof(std::int32_t) * std::uint64_t{word()});
        break;
      case reals:
        skip_bytes(sizeof(double) * std::uint64_t{word()});
        break;
      case complex_numbers:
        skip_bytes(2 * sizeof(double) * std::uint64_t{word()});
        break;
      case raw_bytes:
        skip_bytes(word());
        break;
      case texts:
        skip_texts();
        break;
      case list:
      case expressions:
        for (std::uint32_t left = count(sizeof(std::uint32_t)); left > 0; --left) skip(depth + 1);
        break;
      case environment:  // locked; enclosure, frame, hash table, attributes
        skip_bytes(sizeof(std::uint32_t));
        referable_.emplace_back();
        parts = 4;
        break;
      case external_pointer:
        referable_.emplace_back();
        parts += 2;
        break;
      case weak_reference:
        referable_.emplace_back();
        break;
      case s4_object:
        break;
      case alternative:
        parts = 3;
        break;
      default:
        fail(fmt::format("an object of type {}, which is not read; remove it in R with rm(), and save again",
                         at.type()));
    }
    for (; parts > 0; --parts) skip(depth + 1);
  }

  std::string_view bytes_;
  std::size_t position_ = 0;
  std::size_t described_ = 0;           // elements of sequences so far
  std::vector<std::string> referable_;  // symbols, and other objects without a name
};

}  // namespace

NumericVectors numeric_vectors(std::string_view bytes) {
  return ObjectReader(bytes).read();
}

}  // namespace aloft::importer
