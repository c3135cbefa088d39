#include "services/runtime/flag_checks.hpp"

#include <catch2/catch.hpp>

using namespace aloft::runtime;
using Catch::Contains;

namespace {

/// A validator's message about a value; empty if it is allowed.
std::string said(const CLI::Validator& check, const std::string& value) {
  return check(value);
}

}  // namespace

TEST_CASE("whole numbers: all 64 bits, and none that would be truncated or wrap around") {
  const CLI::Validator seed = whole_number(0, UINT64_MAX);
  for (const char* good : {"0", "1", "007", "18446744073709551615"}) CHECK(said(seed, good).empty());
  for (const char* bad : {"18446744073709551616", "99999999999999999999999", "-1", "-0", "+1", "1.5", "1e3", "0x10", "",
                          " 1", "1 ", "nan", "one"})
    CHECK_THAT(said(seed, bad), Contains("'" + std::string(bad) + "'") && Contains("0 to 18446744073709551615"));
  const CLI::Validator threads = whole_number(1, 256);
  CHECK(said(threads, "256").empty());
  CHECK_THAT(said(threads, "0"), Contains("a whole number from 1 to 256"));
  CHECK_THAT(said(threads, "257"), Contains("a whole number from 1 to 256"));
}

TEST_CASE("numbers: only finite ones, and in range") {
  const CLI::Validator wait_s = number(0.5, 1e6);
  for (const char* good : {"0.5", "1e6", "3", "12.25"}) CHECK(said(wait_s, good).empty());
  for (const char* bad : {"nan", "-nan", "NAN", "nan(1)", "inf", "infinity", "-inf", "1e999", "0.49", "1000001", "-1",
                          "", "3s", "0x10", "1,5"})
    CHECK_THAT(said(wait_s, bad), Contains("a number from 0.5 to 1000000"));
}

TEST_CASE("names: what stands in partitions, file names and logs") {
  for (const char* good : {"w0", "lab", "host.example-17_a", "0123456789abcdef.4711"})
    CHECK(said(bus_name(), good).empty());
  CHECK(said(bus_name(), std::string(64, 'x')).empty());
  for (const std::string& bad : {std::string(), std::string("."), std::string(".."), std::string(".hidden"),
                                 std::string("../../x"), std::string("a/b"), std::string("a b"), std::string("a*"),
                                 std::string("a\nb"), std::string("\xC3\xA9"), std::string(65, 'x')})
    CHECK_THAT(said(bus_name(), bad), Contains("1 to 64 letters, digits"));
}

TEST_CASE("a value of a megabyte is not repeated whole") {
  const std::string megabyte(1 << 20, 'x');
  CHECK(said(bus_name(), megabyte).size() < 400);
  CHECK(said(number(0, 1), megabyte).size() < 400);
  CHECK(said(whole_number(0, 1), megabyte).size() < 400);
}
