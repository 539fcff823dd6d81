// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A name for every piece, and what that costs. All terms are functions of sums over the pieces of each name, so that a
/// change of one piece's name costs a microsecond.
#pragma once
#include <array>
#include <vector>

#include "generator/naming/problem.hpp"

namespace heartgen::naming {

/// Costs by what they are about; all 0 where everything is as usual.
struct Terms {
  double piece = 0;    ///< of pieces by themselves: unnamed blood, ribs, spine
  double missing = 0;  ///< names without blood
  double volume = 0, shape = 0, grey = 0;
  double shell = 0;    ///< the left ventricle without muscle around it
  double place = 0;    ///< centres to each other
  double opening = 0;  ///< no way for the blood where there must be one
  double stream = 0;   ///< grey values of what follows in the stream
  double touch = 0;    ///< open contact of what never opens into each other
  double cut = 0;      ///< borders in the middle of a pool
  double lone = 0;     ///< pieces apart from the rest of their name
  double sum() const {
    return piece + missing + volume + shape + grey + shell + place + opening + stream + touch + cut + lone;
  }
};

class Labelling {
 public:
  explicit Labelling(const Problem& problem);
  Labelling(const Problem& problem, const std::vector<Name>& names);

  void set(int piece, Name name);
  Name operator[](int piece) const { return names_[static_cast<std::size_t>(piece)]; }
  const std::vector<Name>& names() const { return names_; }
  int size() const { return static_cast<int>(names_.size()); }
  Terms terms() const;
  double energy() const {
    return terms().sum();
  }  ///< what changes with one piece's name is computed anew, the rest kept

  bool holds(Name name) const;     ///< as much blood as counts
  bool holds_right_heart() const;  ///< any of it
  double ml(Name name) const;
  double hu(Name name) const;       ///< mean
  Vec3 center_mm(Name name) const;  ///< from the first voxel of the scene
  Vec3 deviation_mm(Name name) const;
  double contact_cm2(Name a, Name b) const;
  double border_cm2(Name name, int side) const;  ///< on the image's border: -x, +x, -y, +y, -z, +z
  Vec3 expected_mm(Name name) const;             ///< where the other names say that its centre is
  const Problem& problem() const { return *problem_; }

 private:
  struct Sums {
    Whole voxels = 0;
    std::array<Whole, 3> index{}, square{};
    Whole hu = 0, hu_square = 0, shell = 0, muscle = 0;
    std::array<Whole, 6> border{};
  };
  void add(const Piece& piece, Name name, Whole sign);
  const Sums& sums(Name name) const { return sums_[static_cast<std::size_t>(name)]; }
  Vec3 mean_shift(Name without) const;
  /// Volume, shape and grey value of one name.
  struct OwnTerms {
    double volume = 0, shape = 0, grey = 0;
  };
  OwnTerms own_terms(Name name) const;
  double visible_share(Name name, const Vec3& shift) const;
  double missing_cost() const;
  double place_cost() const;
  double lone_costs() const;

  const Problem* problem_;
  std::vector<Name> names_;
  std::vector<Whole> same_faces_;  ///< per piece, with pieces of its own name
  std::array<Sums, name_count> sums_{};
  std::array<std::array<Whole, name_count>, name_count> faces_{};  ///< between names, both ways
  Whole own_ = 0, cut_ = 0;
  mutable std::array<OwnTerms, name_count> own_terms_{};
  mutable std::array<bool, name_count> own_terms_known_{};
};

}  // namespace heartgen::naming
