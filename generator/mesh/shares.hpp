// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Smooth shares of labels: a label's indicator under a smoothing that has no bias for what is round.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

/// A box of voxels.
struct Box {
  Index3 low{INT64_MAX, INT64_MAX, INT64_MAX};
  Index3 high{-1, -1, -1};  ///< inclusive
  bool empty() const { return high[0] < 0; }
  bool contains(const Index3& at) const {
    return at[0] >= low[0] && at[1] >= low[1] && at[2] >= low[2] && at[0] <= high[0] && at[1] <= high[1] &&
           at[2] <= high[2];
  }
  void add(const Index3& at);
};

/// A stretch of voxels of each row of a map along its first axis: where something has changed.
struct Spans {
  struct Span {
    std::int64_t first = INT64_MAX, last = -1;  ///< inclusive
    void add(std::int64_t low, std::int64_t high);
    void add(const Span& other) { add(other.first, other.last); }
  };
  Index3 size{};                                   ///< of the map
  std::vector<Span> rows;                          ///< row (j, k) at k * size[1] + j
  Span row(std::int64_t j, std::int64_t k) const;  ///< none beyond the map
  void add(const Box& box);                        ///< the part of it on the map
};
Spans no_spans(const Index3& size);

/// Weights along each axis, of odd count, with sum 1.
using Kernels = std::array<std::vector<float>, 3>;

/// Gaussians of `sigma_voxels` along each axis.
Kernels gaussian_kernels(const Vec3& sigma_voxels);

/// Twice the Gaussian less the Gaussian applied twice: a kernel without a second moment. A Gaussian alone moves a
/// surface of mean curvature H by sigma^2 H towards its hollow side and takes the volume of what is thin.
Kernels sharp_kernels(const Vec3& sigma_voxels);

/// Convolution along the three axes in place, border values continued. The same bits for any number of threads.
/// `scratch` is room to work in, kept from one call to the next: it grows to the volume's size.
void smooth(Volume<float>& volume, const Kernels& kernels, std::vector<float>& scratch);
void smooth(Volume<float>& volume, const Kernels& kernels);

/// Share of one label in the smoothed map, on the box of voxels where it can differ from 0.
struct FractionField {
  std::uint8_t label = 0;  ///< region tag; 0 is the outside
  Index3 first{0, 0, 0};   ///< voxel of the label map where the box begins
  Volume<float> share;     ///< about [0, 1], values at voxel centres
};

/// The smoothed indicator of a label all of whose voxels lie in the box.
FractionField share_field(const LabelVolume& labels, std::uint8_t label, const Box& box, const Kernels& kernels,
                          std::vector<float>& scratch);

/// The share at a voxel of the label map; 0 outside the field's box.
float share_at(const FractionField& field, const Index3& voxel);

/// How far a kernel reaches, in voxels.
Index3 reach_of(const Kernels& kernels);

/// Adds `amount` times the kernel around a voxel of the label map.
void add_kernel(FractionField& field, const Index3& voxel, float amount, const Kernels& kernels);

}  // namespace heartgen::mesh
