#include "csrbf/core/numbers/number_text.hpp"

#include "csrbf/core/numbers/bit_cast.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>

namespace csrbf::number_text_test {
namespace {

std::string text_of(double value) {
  char buffer[32];
  return {buffer, write_number(buffer, buffer + sizeof buffer, value)};
}

TEST(NumberText, ReadsBackWhatItWrote) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100000; ++i) {
    const auto value = bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    const std::string text = text_of(value);
    double read = 0;
    const auto [end, error] = read_number(text.data(), text.data() + text.size(), read);
    ASSERT_EQ(error, std::errc()) << text;
    ASSERT_EQ(end, text.data() + text.size()) << text;
    ASSERT_EQ(bit_cast<std::uint64_t>(read), bit_cast<std::uint64_t>(value)) << text;
  }
}

TEST(NumberText, IsShort) {
  EXPECT_EQ(text_of(.1), "0.1");
  EXPECT_EQ(text_of(-1.5), "-1.5");
  EXPECT_EQ(text_of(1e-300), "1e-300");
  EXPECT_EQ(text_of(1.0 / 3), "0.3333333333333333");
}

TEST(NumberText, RoundsToTheDigitsAskedFor) {
  char buffer[32];
  EXPECT_EQ(std::string(buffer, write_number(buffer, buffer + sizeof buffer, 2.0 / 3, 3)), "0.667");
  EXPECT_EQ(std::string(buffer, write_number(buffer, buffer + sizeof buffer, 1.5, 9)), "1.5");
}

TEST(NumberText, ReadsTheLongestNumber) {
  const struct {
    const char* text;
    double value;
    std::ptrdiff_t length;
  } cases[] = {{"1", 1, 1},
               {"-2.50", -2.5, 5},
               {"3.", 3, 2},
               {".5x", .5, 2},
               {"1e3,", 1000, 3},
               {"1e", 1, 1},
               {"7e+x", 7, 1},
               {"12345678901234567890", 12345678901234567890.0, 20},
               {"0.1000000000000000055511151231257827", .1, 36},
               {"9007199254740993", 9007199254740992.0, 16},
               {"1.7976931348623157e308", std::numeric_limits<double>::max(), 22},
               {"4.9e-324", std::numeric_limits<double>::denorm_min(), 8},
               {"-inf", -std::numeric_limits<double>::infinity(), 4},
               {"0e999", 0, 5}};
  for (const auto& c : cases) {
    const std::string text = c.text;
    double value = -99;
    const auto [end, error] = read_number(text.data(), text.data() + text.size(), value);
    EXPECT_EQ(error, std::errc()) << text;
    EXPECT_EQ(value, c.value) << text;
    EXPECT_EQ(end - text.data(), c.length) << text;
  }
}

TEST(NumberText, RefusesWhatIsNoNumber) {
  for (const std::string text : {"", "-", "+1", " 1", "e5", ".", "x1", "i"}) {
    double value = -99;
    EXPECT_EQ(read_number(text.data(), text.data() + text.size(), value).ec, std::errc::invalid_argument) << text;
    EXPECT_EQ(value, -99) << text;
  }
}

TEST(NumberText, IsInfiniteOrZeroOutOfRange) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::pair<std::string, double> cases[] = {{"1e999", infinity}, {"-1e400", -infinity}, {"1e-400", 0}};
  for (const auto& c : cases) {
    double value = -99;
    const auto [end, error] = read_number(c.first.data(), c.first.data() + c.first.size(), value);
    EXPECT_EQ(error, std::errc::result_out_of_range) << c.first;
    EXPECT_EQ(end, c.first.data() + c.first.size()) << c.first;
    EXPECT_EQ(value, c.second) << c.first;
  }
}

}  // namespace
}  // namespace csrbf::number_text_test
