#include "apps/serve/http_date.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

namespace cuesta::serve {
namespace {

constexpr std::array<std::string_view, 7> days{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
constexpr std::array<std::string_view, 12> months{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                  "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
constexpr int pivot_year = 2026;

/// Text that is eaten from the front; a mismatch sticks.
struct Words {
  std::string_view text;
  bool good = true;

  void literal(std::string_view word) {
    good = good && text.starts_with(word);
    if (good) text.remove_prefix(word.size());
  }
  int number(std::size_t digits) {
    int value = 0;
    good = good && text.size() >= digits;
    for (std::size_t i = 0; good && i < digits; ++i) {
      good = text[i] >= '0' && text[i] <= '9';
      value = value * 10 + (text[i] - '0');
    }
    if (good) text.remove_prefix(digits);
    return value;
  }
  /// asctime's day of the month: a digit may be a space.
  int padded_number() {
    if (text.starts_with(' ')) {
      text.remove_prefix(1);
      return number(1);
    }
    return number(2);
  }
  int month() {
    for (std::size_t m = 0; m < months.size(); ++m)
      if (text.starts_with(months[m])) {
        text.remove_prefix(3);
        return static_cast<int>(m) + 1;
      }
    good = false;
    return 1;
  }
};

struct Moment {
  int year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0;
};

void read_time(Words& w, Moment& m) {
  m.hour = w.number(2);
  w.literal(":");
  m.minute = w.number(2);
  w.literal(":");
  m.second = w.number(2);
}

/// ", 06 Nov 1994 08:49:37 GMT", with other things between day, month and year, and years of so many digits.
Moment read_date(Words& w, std::string_view between, std::size_t year_digits) {
  Moment m;
  w.literal(", ");
  m.day = w.number(2);
  w.literal(between);
  m.month = w.month();
  w.literal(between);
  m.year = w.number(year_digits);
  w.literal(" ");
  read_time(w, m);
  w.literal(" GMT");
  return m;
}

Moment read_fixdate(Words& w) {
  return read_date(w, " ", 4);
}

Moment read_rfc850(Words& w) {
  Moment m = read_date(w, "-", 2);
  m.year += pivot_year - pivot_year % 100;
  if (m.year > pivot_year + 50) m.year -= 100;
  return m;
}

Moment read_asctime(Words& w) {
  Moment m;
  w.literal(" ");
  m.month = w.month();
  w.literal(" ");
  m.day = w.padded_number();
  w.literal(" ");
  read_time(w, m);
  w.literal(" ");
  m.year = w.number(4);
  return m;
}

std::optional<std::int64_t> seconds_of(const Moment& m) {
  using namespace std::chrono;
  const year_month_day date{year(m.year), month(static_cast<unsigned>(m.month)),
                            day(static_cast<unsigned>(m.day))};
  if (!date.ok() || m.hour > 23 || m.minute > 59 || m.second > 60) return std::nullopt;
  return sys_days(date).time_since_epoch().count() * std::int64_t{86400} + m.hour * 3600 + m.minute * 60 +
         m.second;
}

}  // namespace

std::string http_date(std::int64_t unix_s) {
  using namespace std::chrono;
  const std::int64_t day_number = unix_s >= 0 ? unix_s / 86400 : (unix_s - 86399) / 86400;
  const auto rest = static_cast<int>(unix_s - day_number * 86400);
  const sys_days midnight{std::chrono::days(day_number)};
  const year_month_day date(midnight);
  return fmt::format("{}, {:02} {} {:04} {:02}:{:02}:{:02} GMT", days[weekday(midnight).c_encoding()],
                     static_cast<unsigned>(date.day()), months[static_cast<unsigned>(date.month()) - 1],
                     static_cast<int>(date.year()), rest / 3600, rest / 60 % 60, rest % 60);
}

std::optional<std::int64_t> parse_http_date(std::string_view text) {
  const std::size_t name = std::min(text.find_first_of(", "), text.size());
  const std::string_view day_name = text.substr(0, name);
  if (std::none_of(days.begin(), days.end(), [&](std::string_view d) { return day_name.starts_with(d); }))
    return std::nullopt;
  Words w{text.substr(name)};
  const Moment m = day_name.size() > 3       ? read_rfc850(w)
                   : w.text.starts_with(',') ? read_fixdate(w)
                                             : read_asctime(w);
  return w.good && w.text.empty() ? seconds_of(m) : std::nullopt;
}

}  // namespace cuesta::serve
