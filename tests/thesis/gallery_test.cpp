#include "thesis/gallery.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>

#include <set>

namespace csrbf::thesis::gallery_test {
namespace {

TEST(Gallery, NamesAreDistinct) {
  const std::vector<std::string> all = names();
  EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
}

TEST(Gallery, RefusesOtherNamesWithTheList) {
  const std::string message = invalid_input_message([] { static_cast<void>(compute("figure-9.9")); });
  for (const char* part : {"figure-9.9", "there is none of this name", "introduction", "figure-2.4", "table-8.1"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
}

// Claims whose numbers do not show what the thesis says.
std::vector<std::string> failures(const Figure& figure) {
  std::vector<std::string> found;
  for (const Claim& claim : figure.claims)
    if (claim.verdict == Verdict::fails) found.push_back(claim.what);
  return found;
}

TEST(Gallery, FiguresAreWellFormed) {
  for (const char* name : {"introduction", "figure-1.1", "figure-1.2", "figure-2.1", "figure-3.1", "figure-3.10",
                           "figure-4.1", "figure-6.1", "figure-6.3", "figure-6.9", "figure-8.1"}) {
    const Figure figure = compute(name);
    EXPECT_EQ(figure.name, name);
    EXPECT_FALSE(figure.title.empty() || figure.text.empty() || figure.claims.empty()) << name;
    for (const Table& table : figure.tables)
      for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << name << ' ' << table.name;
    for (const Picture& picture : figure.pictures) EXPECT_EQ(picture.values.size(), picture.width * picture.height);
  }
}

TEST(Gallery, SketchesOfTheThesisHold) {
  for (const char* name : {"introduction", "figure-1.1", "figure-1.2", "figure-3.1", "figure-3.10", "figure-4.1",
                           "figure-6.1", "figure-6.9", "figure-8.1"})
    EXPECT_EQ(failures(compute(name)), std::vector<std::string>{}) << name;
}

// Errata: the C4 functions of theorem 2.1 and of Table 2.3 for d = 1, and the smoothness of two decay functions.
TEST(Gallery, MisprintsFail) {
  EXPECT_EQ(failures(compute("figure-2.1")).size(), 2);
  EXPECT_EQ(failures(compute("figure-6.3")),
            (std::vector<std::string>{"smoothness of (d^2 - 1)^2", "smoothness of 1 - 10 d^3 + 15 d^4 - 6 d^5"}));
}

}  // namespace
}  // namespace csrbf::thesis::gallery_test
