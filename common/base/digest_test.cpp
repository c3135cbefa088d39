#include "common/base/digest.hpp"

#include <catch2/catch.hpp>

TEST_CASE("SHA-256 of FIPS 180-4's example") {
  CHECK(aloft::sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(aloft::sha256_id("abc") == 0xba7816bf8f01cfeaU);
  aloft::Digest digest;
  digest.add("a");
  digest.add("bc");
  CHECK(digest.hex() == aloft::sha256_hex("abc"));
}

TEST_CASE("a file that changed since an experiment was resolved is refused, with the remedy") {
  const std::string before = aloft::sha256_hex("abc");
  CHECK_NOTHROW(aloft::check_unchanged("x.csv", "abc", before, "use it"));
  CHECK_NOTHROW(aloft::check_unchanged("x.csv", "abd", "", "use it"));
  CHECK_THROWS_WITH(aloft::check_unchanged("x.csv", "abd", before, "use it"),
                    "'x.csv' has changed since the experiment was resolved: its SHA-256 is " +
                        aloft::sha256_hex("abd") + ", not " + before + "; use it");
}
