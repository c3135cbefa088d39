#include "tools/importer/npz.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::importer {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr zip_int64_t most_members = 64;
constexpr std::string_view npy_magic = "\x93NUMPY";

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseMember {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

/// What follows "'key':" in the header of an NPY file, a Python dictionary.
std::optional<std::string_view> value_after(std::string_view header, std::string_view key) {
  const std::string quoted = fmt::format("'{}':", key);
  const std::size_t at = header.find(quoted);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view value = header.substr(at + quoted.size());
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

template <class Number>
double number_at(const char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

/// An archive in memory; the bytes must outlive it.
std::unique_ptr<zip_t, CloseArchive> open_archive(std::string_view bytes, const std::string& name) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error);
  if (archive == nullptr) {
    const std::string reason = zip_error_strerror(&error);
    zip_source_free(source);
    zip_error_fini(&error);
    throw InputError("{}: this is no NPZ file ({}); write one with numpy.savez or numpy.savez_compressed", name,
                     excerpt(reason));
  }
  zip_error_fini(&error);
  return std::unique_ptr<zip_t, CloseArchive>(archive);
}

/// The content of a member, at most `room` bytes. What the archive says of its size is not believed.
std::string read_member(zip_t* archive, zip_uint64_t index, std::size_t room, const std::string& name) {
  const std::unique_ptr<zip_file_t, CloseMember> member(zip_fopen_index(archive, index, 0));
  if (!member) throw InputError("{}: cannot be read ({}); write the file again", name, zip_strerror(archive));
  std::string bytes;
  std::array<char, 65'536> part{};
  while (true) {
    const zip_int64_t count = zip_fread(member.get(), part.data(), part.size());
    if (count < 0) throw InputError("{}: is damaged ({}); write the file again", name, zip_file_strerror(member.get()));
    if (count == 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(count));
    if (bytes.size() > room)
      throw InputError("{}: with it the arrays of the file are too large; use float32, or a coarser map", name);
  }
}

}  // namespace

NpyArray::NpyArray(std::string bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {
  constexpr std::size_t version_at = npy_magic.size();
  constexpr std::size_t length_at = version_at + 2;
  const std::string_view all = bytes_;
  const std::size_t length_bytes = all.size() > version_at && all[version_at] >= 2 ? 4 : 2;
  if (!all.starts_with(npy_magic) || all.size() < length_at + length_bytes)
    throw InputError("{}: this is no array of NumPy (NPY file)", name_);
  std::uint32_t length = 0;
  std::memcpy(&length, all.data() + length_at, length_bytes);
  begin_ = length_at + length_bytes + length;
  if (begin_ > all.size()) throw InputError("{}: ends within its header; write the file again", name_);
  read_header(all.substr(length_at + length_bytes, length));
  if (size_ * width_ != all.size() - begin_)
    throw InputError("{}: has {} bytes of elements, but its shape ({}) means {} elements of {} bytes; write it again",
                     name_, all.size() - begin_, fmt::join(shape_, ", "), size_, width_);
}

void NpyArray::read_header(std::string_view header) {
  const auto type = value_after(header, "descr");
  const auto order = value_after(header, "fortran_order");
  const auto shape = value_after(header, "shape");
  if (!type || !order || !shape)
    throw InputError("{}: its header has no descr, fortran_order and shape; write it with NumPy", name_);
  const std::string_view text = type->substr(0, type->find(','));
  if (text != "'<f4'" && text != "'<f8'" && text != "'<i4'" && text != "'<i8'")
    throw InputError("{}: has elements of type {}; use '<f4', '<f8', '<i4' or '<i8': array.astype(numpy.float32)",
                     name_, excerpt(text));
  kind_ = text[2];
  width_ = text[3] == '4' ? 4 : 8;
  fortran_order_ = order->starts_with("True");
  read_shape(shape->substr(0, shape->find(')')));
}

void NpyArray::read_shape(std::string_view tuple) {
  size_ = 1;
  const std::string_view digits = "0123456789";
  for (std::size_t at = tuple.find_first_of(digits); at != std::string_view::npos;) {
    const std::size_t end = std::min(tuple.find_first_not_of(digits, at), tuple.size());
    const auto extent = number_in<std::uint64_t>(tuple.substr(at, end - at));
    if (!extent || *extent == 0 || *extent > most_array_bytes / size_)
      throw InputError("{}: has the shape {}); all extents must be 1 at least, and their product {} at most", name_,
                       excerpt(tuple), most_array_bytes);
    shape_.push_back(*extent);
    size_ *= *extent;
    at = tuple.find_first_of(digits, end);
  }
}

double NpyArray::operator[](std::size_t index) const {
  std::size_t place = index;
  if (fortran_order_) {
    place = 0;
    std::size_t stride = size_;
    for (auto extent = shape_.rbegin(); extent != shape_.rend(); ++extent) {
      stride /= *extent;
      place += index % *extent * stride;
      index /= *extent;
    }
  }
  const char* const bytes = bytes_.data() + begin_ + place * width_;
  if (kind_ == 'f') return width_ == 4 ? number_at<float>(bytes) : number_at<double>(bytes);
  return width_ == 4 ? number_at<std::int32_t>(bytes) : number_at<std::int64_t>(bytes);
}

NpzFile::NpzFile(std::string_view bytes, std::string name, std::size_t most_bytes) : name_(std::move(name)) {
  const auto archive = open_archive(bytes, name_);
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  if (count < 1) throw InputError("{}: this is no NPZ file (it is empty); write one with numpy.savez", name_);
  if (count > most_members) throw InputError("{}: has {} members; at most {} are possible", name_, count, most_members);
  std::size_t room = most_bytes;  // of all members together: a small file can expand to any size
  for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(count); ++i) {
    std::string member = zip_get_name(archive.get(), i, 0);
    std::string content = read_member(archive.get(), i, room, fmt::format("{}: {}", name_, excerpt(member)));
    room -= content.size();
    if (member.ends_with(".npy")) member.resize(member.size() - 4);
    members_.push_back({std::move(member), std::move(content)});
  }
}

bool NpzFile::has(std::string_view array) const {
  return std::ranges::find(members_, array, &Member::name) != members_.end();
}

NpyArray NpzFile::array(std::string_view array) const {
  const auto member = std::ranges::find(members_, array, &Member::name);
  if (member == members_.end()) {
    std::vector<std::string> names;
    std::ranges::transform(members_, std::back_inserter(names), [](const Member& one) { return excerpt(one.name); });
    throw InputError("{}: has no array '{}'.{} It has {}", name_, array, did_you_mean(array, names),
                     names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
  }
  return {member->bytes, fmt::format("{}: {}", name_, array)};
}

}  // namespace aloft::importer
