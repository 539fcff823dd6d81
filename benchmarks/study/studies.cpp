// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/studies.hpp"

#include <array>

namespace heartgen::study {

std::span<const StudyEntry> all_studies() {
  static constexpr std::array<StudyEntry, 5> entries = {
      {{"lengths", "five lengths of an implicit curve: Table 5.1, Figs 5.2 and 5.3", study_lengths},
       {"discretisations", "seven discretisations of the flow: Table 5.2, Figs 5.4 to 5.6", study_discretisations},
       {"initial", "four initial conditions: Figs 5.9 and 5.13", study_initial},
       {"phases", "two level sets, layers, the hierarchy, L1 and L2: Figs 5.14, 5.15 and 5.19", study_phases},
       {"hierarchy", "the hierarchy on a slice of the phantom: Tables 5.3 to 5.6", study_hierarchy}}};
  return entries;
}

}  // namespace heartgen::study
