#include "common/base/plain_text.hpp"

#include <rapidcheck.h>

#include <algorithm>
#include <catch2/catch.hpp>

using namespace aloft;
using namespace std::string_literals;

TEST_CASE("plain text is left as it is") {
  CHECK(plain_text("") == "");
  CHECK(plain_text(R"(world.x: "a\b" is not allowed)") == R"(world.x: "a\b" is not allowed)");
  CHECK(plain_text("Höhe über Wien: 120 m, 高度, 🛩") == "Höhe über Wien: 120 m, 高度, 🛩");
}

TEST_CASE("terminal commands and forged line breaks are escaped") {
  CHECK(plain_text("\033[2J\033]0;title\a") == R"(\x1b[2J\x1b]0;title\x07)");
  CHECK(plain_text("a\r\tb\0c\x7f"s) == R"(a\r\tb\x00c\x7f)");
  CHECK(plain_text("\u009b2J") == R"(\x9b2J)");                            // CSI in one character
  CHECK(plain_text("abc\u202edcba\u2066x") == R"(abc\u202edcba\u2066x)");  // turn the direction of writing
  CHECK(plain_text("a\u2028b\U000e0041") == R"(a\u2028b\U000e0041)");      // line separator, invisible tag
  CHECK(plain_text("one\ntwo\n\"three\"\n") == "one; two; \"three\"");
  CHECK(plain_lines("one\n\033two\n") == "one\n\\x1btwo\n");
}

TEST_CASE("bytes that are not UTF-8 are escaped") {
  CHECK(plain_text("\xff\xfe") == R"(\xff\xfe)");
  CHECK(plain_text("a\xc3") == R"(a\xc3)");                // cut in the middle
  CHECK(plain_text("\xc0\xafx") == R"(\xc0\xafx)");        // '/' in two bytes
  CHECK(plain_text("\xed\xa0\x80") == R"(\xed\xa0\x80)");  // half of a surrogate pair
  CHECK(plain_text("\xc3\"\xa4") == R"(\xc3"\xa4)");
}

TEST_CASE("long text is cut between characters, with its size") {
  CHECK(plain_text("abcdef", 6) == "abcdef");
  CHECK(plain_text("abcdef", 4) == "abcd... (6 bytes)");
  CHECK(plain_text("abäöü", 5) == "abä... (8 bytes)");
  CHECK(plain_text(std::string(1'000'000, 'x'), 20) == std::string(20, 'x') + "... (1000000 bytes)");
  CHECK(beginning_of("高度", 3) == "高");
  CHECK(beginning_of("高度", 5) == "高");
  CHECK(beginning_of("高度", 2).empty());
  CHECK(beginning_of("\x80\x80\x80\x80\x80\x80", 5).size() == 5);
}

TEST_CASE("any bytes become one line of printable UTF-8") {
  CHECK(rc::check([](const std::string& text, const std::vector<unsigned char>& bytes) {
    std::string mixed = text + std::string(bytes.begin(), bytes.end());
    const std::string plain = plain_text(mixed);
    for (const char c : plain) RC_ASSERT(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    RC_ASSERT(plain_text(plain) == plain);  // unchanged, so it is printable UTF-8
  }));
}
