#include "apps/plot/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cuesta::plot {
namespace {

struct Unit {
  double size;
  const char* name;
};

/// A typographic minus.
std::string signed_text(std::string text) {
  if (!text.empty() && text[0] == '-') text.replace(0, 1, "−");
  return text;
}

std::string superscript(int number) {
  static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
  return text;
}

std::string without_zeros(std::string text) {
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string power_of_ten(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
  const std::string factor = without_zeros(fmt::format("{:.2f}", value / std::pow(10.0, exponent)));
  const std::string power = "10" + superscript(exponent);
  if (factor == "1") return power;
  return signed_text(factor) + "×" + power;
}

/// 1, 2 or 5 times a power of ten, at least `step`.
double round_step(double step) {
  const double power = std::pow(10.0, std::floor(std::log10(step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= step * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

double linear_step(const Scale& scale, int wanted) {
  return round_step((scale.high - scale.low) / std::max(wanted, 1));
}

/// The largest named unit that `size` reaches; plain numbers below 10⁴.
Unit unit_of(double size) {
  for (const Unit& unit : {Unit{1e9, " G"}, Unit{1e6, " M"}, Unit{1e3, " k"}}) {
    if (size >= std::max(unit.size, 1e4) * (1 - 1e-9)) return unit;
  }
  return {1, ""};
}

std::string in_unit(double value, const Unit& unit, int decimals) {
  return signed_text(without_zeros(fmt::format("{:.{}f}", value / unit.size, decimals))) + unit.name;
}

/// One unit and one number of decimals for the whole axis.
std::vector<Tick> linear_ticks(const Scale& scale, int wanted) {
  const double step = linear_step(scale, wanted);
  const double largest = std::max(std::abs(scale.low), std::abs(scale.high));
  const bool tiny = largest < 1e-3, huge = largest >= 1e12;
  const Unit unit = unit_of(largest);
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step / unit.size) - 1e-9)));
  std::vector<Tick> result;
  for (double i = std::ceil(scale.low / step - 1e-9); i * step <= scale.high + 1e-9 * step; ++i) {
    const double value = i * step;
    result.push_back({value, i == 0         ? "0"
                             : tiny || huge ? power_of_ten(value)
                                            : in_unit(value, unit, decimals)});
  }
  return result;
}

/// Labels at 1 (or at 1, 2, 5) in each decade; other multiples are minor.
std::vector<Tick> logarithmic_ticks(const Scale& scale, int wanted) {
  const double decades = std::log10(scale.high / scale.low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(wanted, 1) - 1e-9)));
  std::vector<Tick> result;
  for (int e = static_cast<int>(std::floor(std::log10(scale.low) + 1e-9)); e <= std::log10(scale.high) + 1e-9;
       ++e) {
    for (int factor = 1; factor < 10; ++factor) {
      const double value = factor * std::pow(10.0, e);
      if (value < scale.low * (1 - 1e-9) || value > scale.high * (1 + 1e-9)) continue;
      const bool labelled = factor == 1 ? e % every == 0 : decades < 2.2 && (factor == 2 || factor == 5);
      if (!labelled && every > 1 && factor > 1) continue;
      result.push_back({value, labelled ? short_number(value, 3) : ""});
    }
  }
  return result;
}

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value) + 1e-9));
  return value >= 5 * power * (1 - 1e-9) ? 5 * power : value >= 2 * power * (1 - 1e-9) ? 2 * power : power;
}

}  // namespace

bool Scale::accepts(double value) const {
  return std::isfinite(value) && (!logarithmic || value > 0);
}

double Scale::operator()(double value) const {
  const double share =
      logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return from_px + share * (to_px - from_px);
}

std::vector<Tick> ticks(const Scale& scale, int wanted) {
  return scale.logarithmic ? logarithmic_ticks(scale, wanted) : linear_ticks(scale, wanted);
}

void widen(Scale& scale, int wanted) {
  if (scale.logarithmic) {
    scale.low = round_down(scale.low);
    scale.high = round_step(scale.high);
    return;
  }
  const double step = linear_step(scale, wanted);
  scale.low = std::floor(scale.low / step + 1e-9) * step;
  scale.high = std::ceil(scale.high / step - 1e-9) * step;
}

std::string short_number(double value, int decimals) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 0.99e-3 || size >= 1e12) return power_of_ten(value);
  return in_unit(value, unit_of(size), decimals);
}

}  // namespace cuesta::plot
