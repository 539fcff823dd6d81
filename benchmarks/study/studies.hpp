// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The studies: thesis chapter 5, one function per question. Each prints nothing, and returns its tables, curves,
/// pictures and what became of the thesis's statements.
#pragma once
#include <span>

#include "benchmarks/study/study.hpp"

namespace heartgen::study {

struct StudySettings {
  bool quick = false;  ///< smaller images and fewer iterations: seconds instead of minutes, coarser statements
  std::function<void(const std::string&)> progress{};  ///< told what begins; may be empty
};

/// 5.1.1: Table 5.1, Figs 5.2 and 5.3, and the areas of a sphere.
StudyResult study_lengths(const StudySettings& settings);
/// 5.1.2: Table 5.2 and Figs 5.4 to 5.6 on an image of our own.
StudyResult study_discretisations(const StudySettings& settings);
/// 5.2: Figs 5.9 and 5.13.
StudyResult study_initial(const StudySettings& settings);
/// 4.4.2 and 5.3: two level sets, layers and the hierarchy on flat regions (Figs 5.14, 5.15), and L1 against L2 (5.19).
StudyResult study_phases(const StudySettings& settings);
/// 5.3 and 5.4: the roads of Tables 5.3 to 5.6 on a slice of the phantom, by the scheme of the thesis and by the
/// recipe's tree.
StudyResult study_hierarchy(const StudySettings& settings);

struct StudyEntry {
  const char* name;
  const char* what;
  StudyResult (*run)(const StudySettings&);
};
/// All of them, in the order of the thesis.
std::span<const StudyEntry> all_studies();

}  // namespace heartgen::study
