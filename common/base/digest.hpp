#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace aloft {

/// SHA-256 (OpenSSL) of everything added, as 64 hexadecimal digits.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void add(std::string_view bytes);
  /// Ends the digest; call once.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// The first 64 bits of the SHA-256: ids.
[[nodiscard]] std::uint64_t sha256_id(std::string_view bytes);

}  // namespace aloft
