#include "apps/serve/metrics.h"

#include <fmt/format.h>

#include <iterator>

namespace cuesta::serve {
namespace {

class Text {
 public:
  void head(std::string_view name, std::string_view type, std::string_view help) {
    fmt::format_to(std::back_inserter(out_), "# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
  }
  template <class Number>
  void sample(std::string_view name, std::string_view labels, Number value) {
    fmt::format_to(std::back_inserter(out_), "{}{} {}\n", name, labels, value);
  }
  void counter(std::string_view name, std::string_view help, std::uint64_t value) {
    head(name, "counter", help);
    sample(name, "", value);
  }
  std::string take() { return fmt::to_string(out_); }

 private:
  fmt::memory_buffer out_;
};

void put_durations(Text& text, const std::vector<const Counters*>& threads) {
  constexpr std::string_view name = "cuesta_response_seconds";
  text.head(name, "histogram", "From a request's head to the last byte of its response.");
  std::uint64_t count = 0;
  double sum = 0;
  for (std::size_t i = 0; i < Counters::duration_bounds_s.size() + 1; ++i) {
    for (const Counters* t : threads) count += t->durations[i].load(std::memory_order_relaxed);
    const std::string bound = i < Counters::duration_bounds_s.size()
                                  ? fmt::format("{{le=\"{}\"}}", Counters::duration_bounds_s[i])
                                  : "{le=\"+Inf\"}";
    text.sample("cuesta_response_seconds_bucket", bound, count);
  }
  for (const Counters* t : threads)
    sum += static_cast<double>(t->duration_us.load(std::memory_order_relaxed)) / 1e6;
  text.sample("cuesta_response_seconds_sum", "", sum);
  text.sample("cuesta_response_seconds_count", "", count);
}

}  // namespace

void Counters::add_duration(double seconds) {
  std::size_t i = 0;
  while (i < duration_bounds_s.size() && seconds > duration_bounds_s[i]) ++i;
  add(durations[i]);
  add(duration_us, static_cast<std::uint64_t>(seconds * 1e6));
}

std::string metrics_text(const std::vector<const Counters*>& threads, const std::vector<Gauge>& gauges) {
  const auto sum = [&](auto member) {
    std::uint64_t total = 0;
    for (const Counters* t : threads) total += (t->*member).load(std::memory_order_relaxed);
    return total;
  };
  Text text;
  text.head("cuesta_responses_total", "counter", "Responses by class of status.");
  for (std::size_t c = 1; c < 6; ++c) {
    std::uint64_t total = 0;
    for (const Counters* t : threads) total += t->responses[c].load(std::memory_order_relaxed);
    text.sample("cuesta_responses_total", fmt::format("{{class=\"{}xx\"}}", c), total);
  }
  text.counter("cuesta_sent_bytes_total", "Bytes handed to the system.", sum(&Counters::sent_bytes));
  text.counter("cuesta_connections_accepted_total", "Connections taken.", sum(&Counters::accepted));
  text.counter("cuesta_connections_refused_total", "Connections refused for there were too many.",
               sum(&Counters::refused_connections));
  text.counter("cuesta_connections_displaced_total", "Waiting connections closed for another one's sake.",
               sum(&Counters::displaced_connections));
  text.counter("cuesta_connections_timed_out_total", "Connections closed for they were too slow.",
               sum(&Counters::timed_out));
  text.counter("cuesta_clients_gone_total", "Clients that went before the end of a response.",
               sum(&Counters::clients_gone));
  text.counter("cuesta_files_failed_total", "Responses cut short by the disk.", sum(&Counters::files_failed));
  text.head("cuesta_connections", "gauge", "Connections that are open.");
  text.sample("cuesta_connections", "", sum(&Counters::open));
  put_durations(text, threads);
  for (const Gauge& g : gauges) {
    text.head(g.name, g.counts_up ? "counter" : "gauge", g.help);
    text.sample(g.name, "", g.value);
  }
  return text.take();
}

}  // namespace cuesta::serve
