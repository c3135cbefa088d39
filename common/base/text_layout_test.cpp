#include "common/base/text_layout.hpp"

#include <catch2/catch.hpp>
#include <sstream>

using namespace aloft;

namespace {

std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, display_width(line));
  return widest;
}

/// Agents with a number, an interval, and two columns that can be left out.
TextTable example() {
  TextTable table({{"agent"}, {"bit/s/Hz"}, {"[95 %]"}, {"height m", 2}, {"gain over min-height"}, {"kJ", 1}});
  table.add({"min-height", "10.20", "[9.81, 10.63]", "30.0", "+0.00", "12.6"});
  table.add({"optimal-height", "20.30", "[19.80, 20.71]", "115.2", {"+10.10 [9.42, 10.80]", true}, "45.3"});
  return table;
}

}  // namespace

TEST_CASE("the width of a line is that of its characters in a terminal", "[text-layout]") {
  CHECK(display_width("") == 0);
  CHECK(display_width("abc") == 3);
  CHECK(display_width("± µ km²") == 7);
  CHECK(display_width("高さ") == 4);     // two wide ones
  CHECK(display_width("e\u0301") == 1);  // an accent that joins the letter before it
  CHECK(display_width("a\xff\xfe"
                      "b") == 4);  // no UTF-8
}

TEST_CASE("a line is cut between characters and ends in an ellipsis", "[text-layout]") {
  CHECK(cut_to("twelve chars", 12) == "twelve chars");
  CHECK(cut_to("twelve chars", 11) == "twelve cha…");
  CHECK(cut_to("±±±±", 3) == "±±…");
  CHECK(cut_to("高高高", 4) == "高…");  // half a character is none
  CHECK(cut_to("abc", 1) == "…");
  CHECK(cut_to("abc", 0).empty());
  CHECK(cut_to("\xff\xff\xff", 2) == "\xff…");
  for (std::size_t width = 0; width < 12; ++width)
    CHECK(display_width(cut_to("a高±e\u0301 \xffz高高b", width)) <= width);
}

TEST_CASE("text is broken at spaces, with indents", "[text-layout]") {
  CHECK(wrapped("one two three", 9) == "one two\nthree\n");
  CHECK(wrapped("one two three", 13) == "one two three\n");
  CHECK(wrapped("one two three", unlimited_width) == "one two three\n");
  CHECK(wrapped("one two three", 9, "- ", "  ") == "- one two\n  three\n");
  CHECK(wrapped("incomprehensibilities are words", 8) == "incomprehensibilities\nare\nwords\n");
  CHECK(wrapped("first\nsecond line", 8) == "first\nsecond\nline\n");
  CHECK(wrapped("one  two   three", 10) == "one  two\nthree\n");  // wider gaps stay, but not at a break
  CHECK(wrapped("µµµ µµµ", 7) == "µµµ µµµ\n");
  CHECK(wrapped("", 8) == "\n");
  CHECK(wrapped("", 8, "- ") == "- \n");
}

TEST_CASE("a table that fits shows everything, aligned", "[text-layout]") {
  CHECK(example().text({}) ==
        "  agent           bit/s/Hz          [95 %]  height m  gain over min-height    kJ\n"
        "  min-height         10.20   [9.81, 10.63]      30.0                 +0.00  12.6\n"
        "  optimal-height     20.30  [19.80, 20.71]     115.2  +10.10 [9.42, 10.80]  45.3\n");
  CHECK(example().fitting_rank({}) == 2);
}

TEST_CASE("a narrow table leaves out the columns of the greatest ranks first, and breaks the rest into blocks",
          "[text-layout]") {
  const TextTable table = example();
  CHECK(table.fitting_rank({.width = 80}) == 2);
  CHECK(table.fitting_rank({.width = 79}) == 1);
  CHECK(table.left_out(2, {.width = 80}).empty());
  CHECK(table.left_out(1, {.width = 79}) == "Left out to fit 79 columns: height m. --wide shows all.\n");
  CHECK(table.left_out(0, {.width = 60}) == "Left out to fit 60 columns: height m, kJ. --wide shows all.\n");
  CHECK(table.fitting_rank({.brief = true}) == 0);
  CHECK(table.left_out(0, {.brief = true}).empty());
  CHECK(table.fitting_rank({.width = 60}) == 0);
  CHECK(table.text({.width = 60}, 0) ==
        "  agent           bit/s/Hz          [95 %]\n"
        "  min-height         10.20   [9.81, 10.63]\n"
        "  optimal-height     20.30  [19.80, 20.71]\n"
        "\n"
        "  agent           gain over min-height\n"
        "  min-height                     +0.00\n"
        "  optimal-height  +10.10 [9.42, 10.80]\n");
  for (std::size_t width = 36; width <= 100; ++width) {
    CAPTURE(width);
    CHECK(widest_line(table.text({.width = width})) <= width);
    CHECK(widest_line(table.text({.width = width}, table.fitting_rank({.width = width}))) <= width);
  }
}

TEST_CASE("a name is cut when nothing else helps", "[text-layout]") {
  TextTable table({{"agent"}, {"value"}});
  table.add({"dqn-with-a-name-that-is-longer-than-the-terminal-is-wide", "1.00"});
  CHECK(table.text({.width = 30}) == "  agent                  value\n  dqn-with-a-name-that…   1.00\n");
}

TEST_CASE("emphasis takes no room, and is Markdown's in Markdown", "[text-layout]") {
  TextTable table({{"agent"}, {"gain | km²"}});
  table.add({"a", {"+1", true}});
  CHECK(table.text({}) == "  agent  gain | km²\n  a              +1\n");
  CHECK(table.text({.bold = true}) == "  agent  gain | km²\n  a              \033[1m+1\033[0m\n");
  CHECK(table.markdown() == "| agent | gain \\| km² |\n|---|---|\n| a | **+1** |\n");
}
