// What the guard lets through and what it refuses, in both byte orders.
#include "common/bus/guard/datagram_check.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

#include "common/bus/guard/testing/bad_datagrams.hpp"

namespace aloft::bus::guard {
namespace {

using namespace testing;

/// Checks a copy that ends where its memory ends, so that the sanitizers see a read beyond it.
Refusal check(const Bytes& bytes, Claims& claims) {
  const auto copy = std::make_unique<unsigned char[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), copy.get());
  return check_datagram({copy.get(), bytes.size()}, claims);
}

Refusal check(const Bytes& bytes) {
  Claims claims;
  return check(bytes, claims);
}

}  // namespace

TEST_CASE("good datagrams of every kind are accepted") {
  for (const bool little : {false, true})
    for (const auto& [what, bytes] : good_datagrams(little)) {
      INFO(what << (little ? ", little endian" : ", big endian"));
      CHECK(name(check(bytes)) == "none");
    }
}

TEST_CASE("each way to spoil a datagram has its reason") {
  for (const bool little : {false, true})
    for (const Bad& bad : bad_datagrams(little)) {
      INFO(bad.what << (little ? ", little endian" : ", big endian"));
      CHECK(name(check(bad.bytes)) == name(bad.refusal));
    }
}

TEST_CASE("a datagram that is cut at any byte is read no further than its end") {
  for (const bool little : {false, true})
    for (const auto& [what, whole] : good_datagrams(little))
      for (std::size_t size = 0; size < whole.size(); ++size) {
        INFO(what << " cut to " << size);
        const Refusal refusal = check({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        if (size < 20) CHECK(name(refusal) == "header");
      }
}

TEST_CASE("a datagram with any byte changed to any of 8 values is read no further than its end") {
  for (const bool little : {false, true})
    for (const auto& [what, whole] : good_datagrams(little))
      for (std::size_t at = 0; at < whole.size(); ++at)
        for (const unsigned char value : Bytes{0x00, 0x01, 0x03, 0x04, 0x7f, 0x80, 0xfe, 0xff}) {
          Claims claims;
          (void)check(changed(whole, at, value), claims);
          CHECK(claims.fragments.size() <= 2);
        }
}

TEST_CASE("what a datagram claims") {
  for (const bool little : {false, true}) {
    Claims claims;
    const auto good = good_datagrams(little);
    REQUIRE(check(good.at("announcement"), claims) == Refusal::none);
    REQUIRE(claims.announcements.size() == 1);
    CHECK(claims.sender == prefix_of(1));
    CHECK(claims.announcements.front().participant == prefix_of(1));
    CHECK(claims.announcements.front().lease_s == 20);
    CHECK_FALSE(claims.announcements.front().leaving);
    claims = {};
    REQUIRE(check(good.at("fragments"), claims) == Refusal::none);
    REQUIRE(claims.fragments.size() == 2);
    CHECK(claims.fragments.front().sample_bytes == 2048);
    CHECK(claims.fragments.front().total == 2);
    CHECK(claims.fragments.front().arrived == 1);
    claims = {};
    REQUIRE(check(good.at("gap"), claims) == Refusal::none);
    CHECK(claims.missing == widest_gap);
  }
}

}  // namespace aloft::bus::guard
