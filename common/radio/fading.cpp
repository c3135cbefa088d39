#include "common/radio/fading.hpp"

#include <algorithm>
#include <cmath>

#include "common/radio/height_rows.hpp"
#include "common/radio/link_budget.hpp"

namespace aloft::radio {
namespace {

/// Complex amplitude of mean square 1.
struct Amplitude {
  double re = 0.0;
  double im = 0.0;
};

/// A complex Gaussian amplitude by Box-Muller; its angle is pi s with s in (-1, 1).
Amplitude amplitude(std::uint32_t radius_word, std::uint32_t angle_word) noexcept {
  const double radius = std::sqrt(-natural_log(unit_interval(radius_word)));
  const double s = 2.0 * unit_interval(angle_word) - 1.0;
  const double sine_of_size = cos_pi(0.5 - std::fabs(s));
  return {radius * cos_pi(s), radius * (s < 0.0 ? -sine_of_size : sine_of_size)};
}

}  // namespace

void Fading::want(std::uint32_t point, std::uint32_t c, std::uint32_t k, std::span<const std::uint32_t> blocks) {
  switch (kind_) {
    case FadingKind::independent:
      pairs_.insert(pairs_.end(), blocks.size(), pair(c, k));
      blocks_.insert(blocks_.end(), blocks.begin(), blocks.end());
      return;
    case FadingKind::correlated:
      return correlated(point, pair(c, k), blocks);
    case FadingKind::none:
      wanted_.insert(wanted_.end(), blocks.size() * lanes, 1.0);
  }
}

std::span<const double> Fading::take(std::uint32_t point) {
  if (kind_ == FadingKind::independent) {  // all in one call: the loops over random words are vectorised
    words_.resize(blocks_.size() * lanes);
    stream_.blocks(point, pairs_, blocks_, words_.data());
    wanted_.resize(words_.size());
    exponential_row(words_, wanted_.data());
    pairs_.clear();
    blocks_.clear();
  }
  values_.swap(wanted_);
  wanted_.clear();
  return values_;
}

std::span<const double> Fading::at_height(std::uint32_t point, std::span<const std::uint32_t> pairs,
                                          std::uint32_t height) {
  const std::uint32_t block = height / lanes;
  values_.resize(pairs.size());
  switch (kind_) {
    case FadingKind::independent:
      blocks_.assign(pairs.size(), block);
      words_.resize(pairs.size() * lanes);
      stream_.blocks(point, pairs, blocks_, words_.data());
      for (std::size_t i = 0; i < pairs.size(); ++i) words_[i] = words_[i * lanes + height % lanes];
      exponential_row(std::span(words_).first(pairs.size()), values_.data());
      blocks_.clear();
      break;
    case FadingKind::correlated:
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        wanted_.clear();
        correlated(point, pairs[i], std::span(&block, 1));
        values_[i] = wanted_[height % lanes];
      }
      wanted_.clear();
      break;
    case FadingKind::none:
      std::ranges::fill(values_, 1.0);
  }
  return values_;
}

void Fading::correlated(std::uint32_t point, std::uint32_t pair, std::span<const std::uint32_t> blocks) {
  const double innovation = std::sqrt(1.0 - correlation_ * correlation_);
  const std::uint32_t heights = blocks.empty() ? 0 : (blocks.back() + 1) * lanes;
  auto wanted = blocks.begin();
  Amplitude value;
  for (std::uint32_t i = 0; i < heights; ++i) {
    if (i == 0 || innovation > 0.0) {  // two heights per block of words, two words each
      const auto words = stream_.block(point, pair, i / 2);
      const Amplitude fresh = i % 2 == 0 ? amplitude(words[0], words[1]) : amplitude(words[2], words[3]);
      value = i == 0 ? fresh
                     : Amplitude{correlation_ * value.re + innovation * fresh.re,
                                 correlation_ * value.im + innovation * fresh.im};
    }
    if (i / lanes != *wanted) continue;
    wanted_.push_back(value.re * value.re + value.im * value.im);
    if (i % lanes == lanes - 1) ++wanted;
  }
}

}  // namespace aloft::radio
