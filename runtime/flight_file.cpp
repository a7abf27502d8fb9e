#include "runtime/flight_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "ooc/atomic_file.h"

namespace cuesta {
namespace {

using Json = nlohmann::json;

/// Where and why a value is not what a flight needs.
struct Complaint {
  std::string message;
};

std::string line_of_byte(std::string_view text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return "line " + std::to_string(std::count(text.begin(), end, '\n') + 1);
}

/// Line on which the n-th object within "keyframes" starts; keyframes hold no strings, so brackets tell.
std::string line_of_keyframe(std::string_view text, std::size_t n) {
  std::size_t at = text.find("\"keyframes\"");
  for (std::size_t i = 0; at != std::string_view::npos && i <= n; ++i) at = text.find('{', at + 1);
  const std::string which = "keyframe " + std::to_string(n);
  return at == std::string_view::npos ? which : line_of_byte(text, at) + ", " + which;
}

double number(const Json& value, const char* what) {
  if (!value.is_number())
    throw Complaint{std::string(what) + " must be a number, found " + value.type_name()};
  const double v = value.get<double>();
  if (!std::isfinite(v)) throw Complaint{std::string(what) + " is not finite"};
  return v;
}

Vec3d triple(const Json& value, const char* what) {
  if (!value.is_array() || value.size() != 3)
    throw Complaint{std::string(what) + " must be three numbers [x, y, z]"};
  return {number(value[0], what), number(value[1], what), number(value[2], what)};
}

const Json& member(const Json& object, const char* name) {
  const auto at = object.find(name);
  if (at == object.end()) throw Complaint{"\"" + std::string(name) + "\" is missing"};
  return *at;
}

void only_keys(const Json& object, std::span<const std::string_view> known) {
  for (const auto& [key, value] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw Complaint{"unknown key \"" + key.substr(0, 40) + "\""};
}

Keyframe keyframe(const Json& object) {
  if (!object.is_object())
    throw Complaint{"a keyframe must be an object {\"t\": …, \"eye\": …, \"target\": …}"};
  constexpr std::array<std::string_view, 5> known{"t", "eye", "target", "up", "fov_deg"};
  only_keys(object, known);
  Keyframe k;
  k.time_s = number(member(object, "t"), "\"t\"");
  k.eye = triple(member(object, "eye"), "\"eye\"");
  k.target = triple(member(object, "target"), "\"target\"");
  if (object.contains("up")) k.up = triple(object["up"], "\"up\"");
  if (object.contains("fov_deg")) k.fov_deg = number(object["fov_deg"], "\"fov_deg\"");
  if (k.eye == k.target) throw Complaint{"\"eye\" and \"target\" are the same point"};
  if (k.up == Vec3d{}) throw Complaint{"\"up\" is zero"};
  if (!(k.fov_deg > 0 && k.fov_deg < 180)) throw Complaint{"\"fov_deg\" must be between 0 and 180"};
  return k;
}

/// Throws a Complaint; `n` is then the keyframe that it is about, or npos.
Flight flight_from(const Json& json, std::size_t& n) {
  if (!json.is_object()) throw Complaint{"a flight is an object {\"fps\": …, \"keyframes\": […]}"};
  constexpr std::array<std::string_view, 2> known{"fps", "keyframes"};
  only_keys(json, known);
  Flight flight;
  if (json.contains("fps")) flight.fps = number(json["fps"], "\"fps\"");
  if (!(flight.fps >= 1 && flight.fps <= 1000)) throw Complaint{"\"fps\" must be between 1 and 1000"};
  const Json& keys = member(json, "keyframes");
  if (!keys.is_array() || keys.empty())
    throw Complaint{"\"keyframes\" must be an array of at least one keyframe"};
  for (n = 0; n < keys.size(); ++n) {
    flight.keyframes.push_back(keyframe(keys[n]));
    if (n > 0 && !(flight.keyframes[n].time_s > flight.keyframes[n - 1].time_s))
      throw Complaint{"\"t\" must be greater than in the keyframe before"};
  }
  n = std::string::npos;
  if ((flight.keyframes.back().time_s - flight.keyframes.front().time_s) * flight.fps > max_flight_frames)
    throw Complaint{"the flight has more than ten million frames"};
  return flight;
}

std::string triple_text(Vec3d v) {
  return Json::array({v.x, v.y, v.z}).dump();
}

}  // namespace

Result<Flight> parse_flight(std::string_view text, const std::string& file) {
  std::size_t n = std::string::npos;
  try {
    return flight_from(Json::parse(text), n);
  } catch (const Json::parse_error& e) {
    return fail(ErrorCode::corrupt, file, line_of_byte(text, e.byte),
                e.byte > text.size() ? "the JSON ends too early" : "this is not JSON");
  } catch (const Json::exception&) {
    return fail(ErrorCode::corrupt, file, "", "a number or string in this JSON cannot be read");
  } catch (const Complaint& c) {
    return fail(ErrorCode::invalid_input, file, n == std::string::npos ? "" : line_of_keyframe(text, n),
                c.message);
  }
}

Result<Flight> read_flight(const std::filesystem::path& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (error == std::errc::no_such_file_or_directory)
    return fail(ErrorCode::not_found, path.string(), "", "there is no such flight file");
  if (error) return fail(ErrorCode::io, path.string(), "", error.message());
  if (bytes > max_flight_file_bytes)
    return fail(ErrorCode::out_of_budget, path.string(), "", "a flight file has at most 64 MiB");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (bytes > 0 && !(text << in.rdbuf())) return fail(ErrorCode::io, path.string(), "", "could not be read");
  return parse_flight(text.str(), path.string());
}

std::string flight_text(const Flight& flight) {
  std::string text = "{\"fps\": " + Json(flight.fps).dump() + ", \"keyframes\": [";
  const char* separator = "\n";
  for (const Keyframe& k : flight.keyframes) {
    text += separator;
    text += "  {\"t\": " + Json(k.time_s).dump() + ", \"eye\": " + triple_text(k.eye) +
            ", \"target\": " + triple_text(k.target) + ", \"up\": " + triple_text(k.up) +
            ", \"fov_deg\": " + Json(k.fov_deg).dump() + "}";
    separator = ",\n";
  }
  return text + "\n]}\n";
}

Result<void> write_flight(const std::filesystem::path& path, const Flight& flight) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  const std::string text = flight_text(flight);
  if (auto r = file->write(std::as_bytes(std::span(text))); !r) return r;
  return file->commit();
}

}  // namespace cuesta
