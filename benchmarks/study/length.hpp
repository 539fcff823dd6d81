// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Length of the curve {phi = 0} given on pixels (thesis 5.1.1), and area of the surface {phi = 0} given on voxels.
/// phi may have any sign inside; H(phi) = 1 where phi >= 0. The forward differences D+ are those of (5.4): they are 0
/// across the border of the plane. Sums run row by row, so results have the same bits everywhere.
#pragma once
#include "benchmarks/study/field.hpp"
#include "model/volume.hpp"

namespace heartgen::study {

/// δ_β(x) = exp(-(x/β)²) / (β √π) (5.2) and its derivative.
double gaussian_delta(double x, double beta);
double gaussian_delta_slope(double x, double beta);

/// Σ h² δ_β(phi) |∇+ phi| (5.3). Right for a signed distance function when β is a few pixels and the Gaussian fits into
/// the plane; wrong for any other scaling of phi.
double gaussian_length(const Field& phi, double beta, double spacing = 1);

/// Σ h² |∇+ H(phi)| (5.5): depends on the sign of phi only, hence on no scaling; does not converge as h goes to 0 (for
/// a circle it tends to 1.164 times the length).
double heaviside_length(const Field& phi, double spacing = 1);

struct EdgeCrossings {
  std::int64_t edges = 0;    ///< pixel edges (horizontal and vertical) with a change of sign
  std::int64_t corners = 0;  ///< pixels with a change of sign in both of their forward differences
};
/// heaviside_length = h (edges - (2 - √2) corners).
EdgeCrossings edge_crossings(const Field& phi);

/// Smereka's delta function (5.6; Smereka 2006), summed: Σ h² δ~. It already holds the factor |∇phi| and is therefore
/// the same for m phi. A pixel with phi = 0 exactly belongs to the side phi >= 0: the condition "product <= 0", read
/// literally, would count it on both of its sides.
double smereka_length(const Field& phi, double spacing = 1, double epsilon = 1e-10);

/// The zero line of the linear interpolation on two triangles per square of four pixels. Second order.
double piecewise_linear_length(const Field& phi, double spacing = 1);

/// The same of a surface. Voxels must be cubes (UserError otherwise) except for `tetrahedra_area`, the zero surface
/// of the linear interpolation on six tetrahedra per cube of eight voxels. All in mm².
double gaussian_area(const Volume<double>& phi, double beta_mm);
double heaviside_area(const Volume<double>& phi);
double smereka_area(const Volume<double>& phi, double epsilon = 1e-10);
double tetrahedra_area(const Volume<double>& phi);

}  // namespace heartgen::study
