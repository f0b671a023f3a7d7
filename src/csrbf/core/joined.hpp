#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// "a, b, c".
inline std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// How many letters must be left out, put in, changed or swapped with the next to make one word of the other (the
/// optimal string alignment distance).
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

/// "did you mean kernel? " for the known word that `word` is most probably a slip of; empty when it is like none.
inline std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 64, letters_per_slip = 5;  // chosen by hand
  if (word.size() > longest) return "";
  std::size_t fewest = 2 + word.size() / letters_per_slip;
  std::string best;
  for (const std::string& candidate : known) {
    const std::size_t slips = edit_distance(word, candidate);
    if (slips >= fewest || slips >= word.size()) continue;
    fewest = slips;
    best = "did you mean " + candidate + "? ";
  }
  return best;
}

}  // namespace csrbf
