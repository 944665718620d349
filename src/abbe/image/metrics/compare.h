/// Whether two images are the same for the purposes of a golden test, in OpenImageIO's manner.
#pragma once

#include <cstddef>
#include <string>

#include "abbe/image/image.h"

namespace abbe {

/// As idiff's -fail, -failpercent and -hardfail; the defaults are those of OpenImageIO's own tests.
struct CompareThresholds {
  double fail = 0.004;         ///< A pixel fails when a channel differs by more than this,
  double fail_percent = 0.02;  ///< the image when more than this share of its pixels fail,
  double hard_fail = 0.012;    ///< or when one value differs by more than this.
};

/// What compare_images() found.
struct Comparison {
  bool passed = false;
  std::size_t failed_pixels = 0;  ///< Pixels beyond `fail`.
  double failed_percent = 0.0;
  std::size_t hard_failed_pixels = 0;  ///< Pixels beyond `hard_fail`.
  double mean_error = 0.0;             ///< Over all values; infinite if any error is.
  double rms_error = 0.0;
  /// The largest difference: infinite where a value is not finite and its partner is another.
  double max_error = 0.0;
  int worst_x = 0;
  int worst_y = 0;
  std::string worst_channel;
  float worst_value = 0.0f;      ///< Of the image,
  float worst_reference = 0.0f;  ///< and of the reference.

  /// `3 pixels (0.012 %) beyond 0.004, 0 beyond 0.012, worst 0.0051 at 12,7 R: 0.5 for 0.4949`.
  std::string summary(const CompareThresholds& thresholds) const;
};

/// Compares values as they are, equal infinities and two NaNs being equal.
/// Errors: input Error when sizes, windows or channels differ.
Comparison compare_images(const Image& image, const Image& reference,
                          const CompareThresholds& thresholds = {});

}  // namespace abbe
