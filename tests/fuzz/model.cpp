// Model files: as they are, and the content of such files below their checksum.
#include <google/protobuf/stubs/logging.h>
#include <idl/model.pb.h>

#include "common/agents/pretrained_model.hpp"
#include "common/base/digest.hpp"
#include "tests/fuzz/target.hpp"

namespace {

void read(std::string_view file) {
  aloft::fuzz::accepted([&] {
    const std::string written = aloft::agents::parse_pretrained_model(file, "input").to_bytes();
    aloft::fuzz::require(aloft::agents::parse_pretrained_model(written, "written").to_bytes() == written,
                         "a model changes when written again");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const google::protobuf::LogSilencer quiet;  // it tells of invalid texts
  const std::string_view input = aloft::fuzz::text(data, size);
  read(input);
  aloft::proto::SealedModel sealed;
  sealed.set_format_version(1);
  sealed.set_model(std::string(input));
  sealed.set_sha256(aloft::sha256_hex(input));
  read(sealed.SerializeAsString());
  return 0;
}
