#pragma once

#include <cstdint>
#include <filesystem>
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

/// InputError, ending in `advice`, if `bytes`, which `file` holds, are not those with which an experiment was resolved:
/// `sha256`; empty: any.
void check_unchanged(const std::filesystem::path& file, std::string_view bytes, std::string_view sha256,
                     std::string_view advice);

/// The first 64 bits of the SHA-256: ids.
[[nodiscard]] std::uint64_t sha256_id(std::string_view bytes);

}  // namespace aloft
