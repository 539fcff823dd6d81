// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A function on the pixels of a plane, and the part of the plane on which an equation is solved.
/// Pixels are squares of side 1 unless a function takes a spacing; i runs fastest, j downwards.
#pragma once
#include <cstdint>
#include <vector>

namespace heartgen::study {

/// Values on width × height pixels with a rim of one pixel around them, so that neighbours can be read without asking.
/// The rim holds zeros and means nothing: `Domain` says which neighbours count.
struct Field {
  int width = 0, height = 0;
  std::vector<double> values;  ///< (height + 2) rows of width + 2

  Field() = default;
  Field(int width_px, int height_px, double value = 0);
  double* row(int j) { return values.data() + at(0, j); }
  const double* row(int j) const { return values.data() + at(0, j); }
  double& operator()(int i, int j) { return values[at(i, j)]; }
  double operator()(int i, int j) const { return values[at(i, j)]; }
  std::int64_t pixels() const { return static_cast<std::int64_t>(width) * height; }

 private:
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j + 1) * static_cast<std::size_t>(width + 2) + static_cast<std::size_t>(i + 1);
  }
};

/// One value per pixel of a plane: classes, or 0 and 1.
struct PixelLabels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> values;  ///< i fastest

  PixelLabels() = default;
  PixelLabels(int width_px, int height_px, std::uint8_t value = 0);
  std::uint8_t& operator()(int i, int j) { return values[at(i, j)]; }
  std::uint8_t operator()(int i, int j) const { return values[at(i, j)]; }

 private:
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
  }
};

/// The pixels that take part and the faces between them. A face is open (1) between two pixels of the domain, else
/// closed (0): across closed faces every difference is taken as 0, which is the homogeneous Neumann condition.
struct Domain {
  Field inside;  ///< 1 in the domain, else 0
  Field open_x;  ///< (i, j): the face between (i, j) and (i + 1, j)
  Field open_y;  ///< (i, j): the face between (i, j) and (i, j + 1)
};

Domain whole_plane(int width, int height);
/// The pixels whose label is not 0.
Domain part_of_plane(const PixelLabels& labels);

/// H(phi) of every pixel: 1 where phi >= 0 and the pixel is in the domain.
PixelLabels positive_side(const Field& phi, const Domain& domain);

/// The thesis's distance between two segmentations (5.22): pixels of the domain that differ, either way round,
/// whichever is less, since exchanging the two sides changes nothing.
std::int64_t differing_pixels(const PixelLabels& a, const PixelLabels& b, const Domain& domain);

}  // namespace heartgen::study
