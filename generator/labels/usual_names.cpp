// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/usual_names.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

namespace heartgen::labels {
namespace {

using enum Region;
using Words = std::set<std::string_view>;

/// Other words for one word, or for several.
struct Synonym {
  std::string_view word, meaning;
};
constexpr std::array synonyms = {
    Synonym{"lv", "left ventricle"},
    Synonym{"rv", "right ventricle"},
    Synonym{"la", "left atrium"},
    Synonym{"ra", "right atrium"},
    Synonym{"lvbp", "left ventricle blood"},
    Synonym{"rvbp", "right ventricle blood"},
    Synonym{"lvm", "left ventricle wall"},
    Synonym{"lvmyo", "left ventricle wall"},
    Synonym{"rvm", "right ventricle wall"},
    Synonym{"rvmyo", "right ventricle wall"},
    Synonym{"ao", "aorta"},
    Synonym{"pa", "pulmonary artery"},
    Synonym{"pv", "vein"},
    Synonym{"svc", "vein"},
    Synonym{"ivc", "vein"},
    Synonym{"l", "left"},
    Synonym{"r", "right"},
    Synonym{"ventricular", "ventricle"},
    Synonym{"ventricles", "ventricle"},
    Synonym{"atrial", "atrium"},
    Synonym{"bloodpool", "blood"},
    Synonym{"pool", "blood"},
    Synonym{"bp", "blood"},
    Synonym{"cavity", "blood"},
    Synonym{"lumen", "blood"},
    Synonym{"chamber", "blood"},
    Synonym{"endo", "blood"},
    Synonym{"myocardium", "wall"},
    Synonym{"myocardial", "wall"},
    Synonym{"myo", "wall"},
    Synonym{"muscles", "muscle"},
    Synonym{"walls", "wall"},
    Synonym{"aortic", "aorta"},
    Synonym{"root", "aorta"},
    Synonym{"pulmonic", "pulmonary"},
    Synonym{"trunk", "artery"},
    Synonym{"lungs", "lung"},
    Synonym{"bones", "bone"},
    Synonym{"rib", "bone"},
    Synonym{"ribs", "bone"},
    Synonym{"sternum", "bone"},
    Synonym{"spine", "bone"},
    Synonym{"vertebra", "bone"},
    Synonym{"vertebrae", "bone"},
    Synonym{"skeleton", "bone"},
    Synonym{"body", "torso"},
    Synonym{"skin", "torso"},
    Synonym{"papillaries", "papillary"},
    Synonym{"veins", "vein"},
    Synonym{"vena", "vein"},
    Synonym{"cava", "vein"},
    Synonym{"oesophagus", "esophagus"},
    Synonym{"coronaries", "coronary"},
    Synonym{"arteries", "artery"},
};

/// Words that tell nothing that matters here.
constexpr std::array fillers = {"of",    "the",   "heart",  "cardiac",  "ascending", "descending", "arch",
                                "main",  "label", "region", "superior", "inferior",  "free",       "segment",
                                "upper", "lower", "middle", "lobe",     "thoracic",  "mask"};

/// Structures by the words that they all have; the first that fits counts.
struct Meaning {
  std::array<std::string_view, 3> words;
  Region region;
};
constexpr std::array meanings = {
    Meaning{{"vein"}, none},
    Meaning{{"coronary"}, none},
    Meaning{{"esophagus"}, none},
    Meaning{{"pericardium"}, none},
    Meaning{{"appendage"}, none},
    Meaning{{"papillary"}, papillary},
    Meaning{{"left", "ventricle", "wall"}, lv_myocardium},
    Meaning{{"right", "ventricle", "wall"}, rv_myocardium},
    Meaning{{"left", "ventricle", "muscle"}, lv_myocardium},
    Meaning{{"right", "ventricle", "muscle"}, rv_myocardium},
    Meaning{{"left", "atrium", "wall"}, la_wall},
    Meaning{{"right", "atrium", "wall"}, ra_wall},
    Meaning{{"left", "ventricle"}, lv_blood},
    Meaning{{"right", "ventricle"}, rv_blood},
    Meaning{{"left", "atrium"}, la_blood},
    Meaning{{"right", "atrium"}, ra_blood},
    Meaning{{"pulmonary", "artery"}, pulmonary_artery},
    Meaning{{"aorta"}, aorta},
    Meaning{{"wall"}, lv_myocardium},  // "myocardium"
    Meaning{{"trachea"}, trachea},
    Meaning{{"lung"}, lung},
    Meaning{{"liver"}, liver},
    Meaning{{"bone"}, bone},
    Meaning{{"torso"}, torso},
    Meaning{{"carotid", "artery"}, carotid},
    Meaning{{"carotid"}, carotid},
};

/// Whether a word may stand beside those of a meaning: blood in a cavity or vessel, muscle in what is papillary, a side
/// of what a heart model does not tell apart. "Aortic wall" is no aorta, "right wall" no left ventricle's.
bool may_stand_beside(const Meaning& meaning, std::string_view word) {
  if (meaning.region == none) return true;
  if (word == "blood") return is_blood(meaning.region);
  if (word == "muscle") return meaning.region == papillary;
  const bool is_side = word == "left" || word == "right";
  return is_side && (meaning.region == lung || meaning.region == bone || meaning.region == carotid ||
                     meaning.region == papillary || meaning.region == pulmonary_artery);
}

bool fits(const Meaning& meaning, const Words& words) {
  const auto is_of_meaning = [&](std::string_view word) {
    return std::find(meaning.words.begin(), meaning.words.end(), word) != meaning.words.end();
  };
  return std::all_of(meaning.words.begin(), meaning.words.end(),
                     [&](std::string_view word) { return word.empty() || words.contains(word); }) &&
         std::all_of(words.begin(), words.end(),
                     [&](std::string_view word) { return is_of_meaning(word) || may_stand_beside(meaning, word); });
}

/// The words in one wording; nothing where one is unknown.
std::optional<Words> words_of(const std::string& plain_name, std::vector<std::string>& storage) {
  std::string spaced = plain_name;
  std::replace(spaced.begin(), spaced.end(), '_', ' ');
  std::istringstream given(spaced);
  for (std::string word; given >> word;) {
    const auto* const synonym =
        std::find_if(synonyms.begin(), synonyms.end(), [&](const auto& s) { return s.word == word; });
    std::istringstream meaning(synonym == synonyms.end() ? word : std::string(synonym->meaning));
    for (std::string one; meaning >> one;) storage.push_back(one);
  }
  Words words;
  for (const auto& word : storage) {
    if (std::find(fillers.begin(), fillers.end(), word) != fillers.end()) continue;
    const bool is_known = word == "blood" || std::any_of(meanings.begin(), meanings.end(), [&](const Meaning& m) {
                            return std::find(m.words.begin(), m.words.end(), word) != m.words.end();
                          });
    if (!is_known) return {};
    words.insert(word);
  }
  return words;
}

}  // namespace

std::optional<Region> region_of_words(const std::string& plain_name) {
  std::vector<std::string> storage;
  const auto words = words_of(plain_name, storage);
  if (!words) return {};
  for (const Meaning& meaning : meanings)
    if (fits(meaning, *words)) return meaning.region;
  return {};
}

}  // namespace heartgen::labels
