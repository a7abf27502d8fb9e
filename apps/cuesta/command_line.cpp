#include "apps/cuesta/command_line.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>

#include "apps/cuesta/build_command.h"
#include "apps/cuesta/export_command.h"
#include "apps/cuesta/flight_command.h"
#include "apps/cuesta/info_command.h"
#include "apps/cuesta/machine.h"
#include "apps/cuesta/measure_command.h"
#include "apps/cuesta/render_command.h"
#include "apps/cuesta/sample_command.h"
#include "apps/cuesta/serve_command.h"
#include "apps/cuesta/text_forms.h"
#include "apps/cuesta/verify_command.h"
#include "apps/cuesta/view_command.h"
#include "hierarchy/page_codec.h"

namespace cuesta::app {
namespace {

constexpr int wrong_usage = 1;
constexpr const char* exit_statuses =
    "Exit status: 0 done, 1 wrong usage, 2 not found, 3 corrupt, 4 unsupported, 5 invalid input,\n"
    "6 input/output error, 7 out of budget, 8 cancelled.";

/// What the command that was named does, once everything is parsed.
using Run = std::function<Result<void>()>;

/// Holds for all commands.
struct Common {
  std::uint32_t threads = 0;
  Run run;
};

/// A named command; `settings` live as long as its options.
template <class Settings>
struct Command {
  CLI::App* app;
  std::shared_ptr<Settings> settings = std::make_shared<Settings>();

  Command(CLI::App& program, const char* name, const char* what, const char* more)
      : app(program.add_subcommand(name, what)) {
    app->footer(more);
    app->get_formatter()->column_width(34);
  }
  void runs(Common& common, Result<void> (*command)(const Settings&)) {
    app->callback([&common, command, s = settings] { common.run = [command, s] { return command(*s); }; });
  }
};

/// An option whose words `parse` understands: it returns false for what it does not.
CLI::Option* add_parsed(CLI::App* app, const char* name, const char* words, const std::string& what,
                        std::function<bool(const std::string&)> parse) {
  const auto read = [parse = std::move(parse), name, what](const CLI::results_t& given) {
    if (parse(given.front())) return true;
    throw CLI::ValidationError(name, fmt::format("\"{}\" is not understood; it is: {}", given.front(), what));
  };
  return app->add_option(name, read, what)
      ->type_name(words)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

template <class T>
std::function<bool(const std::string&)> store(std::optional<T> (*parse)(std::string_view), T& where) {
  return [parse, &where](const std::string& text) {
    const auto value = parse(text);
    if (value) where = *value;
    return value.has_value();
  };
}

template <class T>
std::function<bool(const std::string&)> one_of(std::map<std::string, T> choices, T& where) {
  return [choices = std::move(choices), &where](const std::string& text) {
    const auto at = choices.find(text);
    if (at != choices.end()) where = at->second;
    return at != choices.end();
  };
}

CLI::Option* add_path(CLI::App* app, const char* name, std::filesystem::path& where, const char* what) {
  return app->add_option(name, where, what)->type_name(name[0] == '-' ? "FILE" : "");
}

void add_threads(CLI::App* app, Common& common) {
  app->add_option("--threads", common.threads, "threads to use; 1 runs everything inline; default: all")
      ->type_name("N")
      ->check(CLI::Range(1u, 4096u));
}

void add_quiet(CLI::App* app, bool& quiet) {
  app->add_flag("--quiet", quiet, "no progress lines");
}

/// @param up_given  set if --up is among the words.
void add_camera_frame(CLI::App* app, View& view, bool* up_given = nullptr) {
  add_parsed(
      app, "--size", "WxH", "picture size in pixels; default 1280x720",
      [&view](const std::string& text) { return parse_picture_size(text, view.width_px, view.height_px); });
  add_parsed(app, "--fov", "DEGREES", "full vertical angle; default 60", [&view](const std::string& text) {
    double degrees = 0;
    if (!CLI::detail::lexical_cast(text, degrees) || !(degrees > 0 && degrees < 179)) return false;
    view.fov_y_rad = degrees * std::numbers::pi / 180;
    return true;
  });
  add_parsed(app, "--up", "AXIS", "which way is up: x, y, z or =-x, =-y, =-z; default y; terrain: its own up",
             [&view, up_given](const std::string& text) {
               const auto up = parse_axis(text);
               if (up) view.up = *up;
               if (up_given) *up_given = up.has_value();
               return up.has_value();
             });
}

CLI::Option* add_camera(CLI::App* app, std::optional<CameraText>& camera) {
  return add_parsed(app, "--camera", "TEXT",
                    "\"eye x,y,z target x,y,z\" and perhaps \"up x,y,z\", in world units",
                    [&camera](const std::string& text) { return (camera = parse_camera(text)).has_value(); });
}

/// "47.5,-122.25": latitude and longitude.
std::optional<LatLon> parse_lat_lon(std::string_view text) {
  const auto comma = text.find(',');
  LatLon at;
  if (comma == text.npos || !CLI::detail::lexical_cast(std::string(text.substr(0, comma)), at.lat_deg) ||
      !CLI::detail::lexical_cast(std::string(text.substr(comma + 1)), at.lon_deg))
    return std::nullopt;
  return at;
}

void add_terrain(CLI::App* app, TerrainSettings& t) {
  const char* group = "Terrain";
  app->add_option("--crs", t.crs, "where rasters lie that do not say it, or say it wrong")
      ->type_name("EPSG:n")
      ->group(group);
  app->add_option("--geoid", t.geoid,
                  "egm96, egm84, or a .pgm file: makes orthometric heights ellipsoidal, which the\n"
                  "globe and local frames need; default: heights stay as they are")
      ->type_name("NAME")
      ->group(group);
  add_parsed(app, "--heights", "DATUM", "of the files: orthometric or ellipsoidal; default: as they say",
             one_of<VerticalDatum>(
                 {{"orthometric", VerticalDatum::orthometric}, {"ellipsoidal", VerticalDatum::ellipsoidal}},
                 t.heights))
      ->group(group);
  add_parsed(app, "--frame", "KIND",
             "auto, ecef (the globe), enu (east, north, up at a place) or projected (the files'\n"
             "own plane); default auto: projected, else enu up to 10 degrees, else ecef",
             one_of<FrameChoice>({{"auto", FrameChoice::automatic},
                                  {"ecef", FrameChoice::ecef},
                                  {"enu", FrameChoice::enu},
                                  {"projected", FrameChoice::projected}},
                                 t.frame))
      ->group(group);
  add_parsed(app, "--origin", "LAT,LON", "of the frame enu; default: the middle",
             [&t](const std::string& text) { return (t.origin = parse_lat_lon(text)).has_value(); })
      ->group(group);
  add_parsed(
      app, "--priority", "WHICH", "of rasters that overlap: finest, or order (as given); default finest",
      one_of<MosaicPriority>(
          {{"finest", MosaicPriority::finest_first}, {"order", MosaicPriority::given_order}}, t.priority))
      ->group(group);
  app->add_option("--fill", t.fill_postings,
                  "interpolate no-data up to so many postings from data on both sides")
      ->type_name("N")
      ->check(CLI::Range(0u, most_fill_postings))
      ->group(group);
  app->add_option("--sea-level", t.sea_level_m, "water at H metres: no-data, and what is below, becomes it")
      ->type_name("H")
      ->group(group);
  app->add_option("--no-data", t.no_data, "the sample that is no height, instead of the files' own")
      ->type_name("V")
      ->group(group);
  app->add_option("--zoom", t.zoom, "level of a folder of tiles, z/x/y.png; default: the finest")
      ->type_name("Z")
      ->group(group);
  add_path(app, "--drape", t.drape, "image that colours the terrain: JPEG, PNG or GeoTIFF")->group(group);
  add_parsed(app, "--drape-bounds", "W,S,E,N", "degrees between which the image lies, if it does not say so",
             [&t](const std::string& text) { return (t.drape_bounds = parse_geo_box(text)).has_value(); })
      ->group(group);
  app->add_option("--variable", t.variable, "of netCDF files")->type_name("NAME")->group(group);
}

void add_build(CLI::App& program, Common& common) {
  Command<BuildSettings> c(
      program, "build", "Builds a .cuesta file from mesh files, scenes, volumes, or rasters of heights.",
      "Reads PLY, OBJ, STL, OFF, glTF, GLB or Draco; drops what is no surface (degenerate,\n"
      "duplicate and non-finite faces), cuts non-manifold edges, snaps vertices to a grid, and\n"
      "writes all levels of detail into one file. What was dropped is counted and told.\n\n"
      "Meshes of any size are built in the memory given, with temporary data of 100 to 150 bytes per\n"
      "triangle on disk, in FILE.work. A build that is interrupted, by Ctrl-C, a crash or a full\n"
      "disk, goes on from there when the same command is run again.\n\n"
      "Any of them may be inside gzip, Zstandard, xz or zip (scan.ply.gz, scan.obj.zst). Several files "
      "become\n"
      "one surface, in the order given. Where only some have an attribute, vertices of the others get\n"
      "computed normals, white, or (0, 0). Tiles whose borders nearly meet are joined with --weld: TOL\n"
      "is best a little more than the width of the cracks, and less than the borders' edges.\n\n"
      "A volume (OpenVDB, .vdb) is meshed block by block, as it is read: --grid names one of its\n"
      "grids of float, half or double, --iso the value on the surface, --adaptivity merges flat\n"
      "parts. Level sets have their surface at 0 with lower values inside; fog volumes at 0.5\n"
      "with higher values inside; other grids, which count as fog, need --iso.\n\n"
      "Rasters of heights (.hgt, GeoTIFF, ESRI ASCII grid, netCDF, PNG, folders of z/x/y.png, raw\n"
      "samples with a sidecar) become one terrain: any number of tiles, with overlaps and gaps. No-data\n"
      "is a hole, unless --fill or --sea-level say otherwise. Error bounds are vertical, in metres, over\n"
      "every posting.\n\n"
      "A scene (glTF, OBJ, a folder of mesh files) becomes a file of many parts with --type scene: each\n"
      "distinct mesh is stored once, nodes, instances, materials and animations stay. That is also what\n"
      "is made, without --type, of a folder of meshes, and of one glTF file that shows more than one\n"
      "mesh or has animations; --type surface makes one surface of it. Textures are not kept.\n\n"
      "An output that was made by this program from the same bytes with the same options is up to\n"
      "date: nothing is done. (A surface of glTF with buffers in other files is always built.)\n\n"
      "Examples:\n  cuesta build bunny.ply -o bunny.cuesta --memory 4G\n"
      "  cuesta build tiles/*.ply.gz -o city.cuesta --temp /var/tmp\n"
      "  cuesta build smoke.vdb --grid density --iso 0.1 --adaptivity 0.02\n"
      "  cuesta build engine.glb --type scene -o engine.cuesta\n"
      "  cuesta build *.hgt -o alps.cuesta --geoid egm96 --fill 20");
  BuildSettings& s = *c.settings;
  c.app
      ->add_option("INPUT", s.inputs,
                   "mesh files, their formats taken from their contents; or rasters of heights")
      ->type_name("")
      ->required();
  add_path(c.app, "-o,--output", s.output,
           "file to write; default, for one INPUT only: its name with .cuesta, in this folder");
  add_parsed(c.app, "--memory", "SIZE",
             "memory to use, such as 512M or 8G, at least 256M; default: 3/4 of the machine's",
             store(parse_bytes, s.memory_bytes));
  add_path(c.app, "--temp", s.temp, "where the folder with work in progress goes; default: beside the output")
      ->type_name("DIR");
  add_parsed(c.app, "--resume", "WHEN",
             "auto: go on with what an interrupted build left; never; default auto",
             [&s](const std::string& text) {
               s.resume = text == "auto";
               return s.resume || text == "never";
             });
  c.app->add_option("--step", s.step, "grid step in the mesh's units; default: 1/128 of the median edge")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  c.app
      ->add_option("--weld", s.weld,
                   "join open borders: points on them that are this near to each other, in the mesh's\n"
                   "units, become one; default 0: only points that are the same on the grid")
      ->type_name("TOL")
      ->check([](const std::string& text) {
        double tolerance = 0;
        const bool is_good =
            CLI::detail::lexical_cast(text, tolerance) && tolerance >= 0 && std::isfinite(tolerance);
        return is_good ? std::string() : text + " is not a number from 0 on";
      });
  c.app->add_option("--cell", s.cell_triangles, "triangles of a page before it is simplified; default 32768")
      ->type_name("N")
      ->check(CLI::Range(64u, max_page_elements - 1));
  add_parsed(
      c.app, "--type", "TYPE", "auto, surface or scene; default auto",
      one_of<BuildType>(
          {{"auto", BuildType::automatic}, {"surface", BuildType::surface}, {"scene", BuildType::scene}},
          s.type));
  add_parsed(c.app, "--largest-tom", "N",
             "of scenes: parts of more triangles become fan-hierarchies; default 131072",
             store(parse_count, s.largest_tom));
  c.app->add_option("--grid", s.volume.grid, "grid of a volume; default: its first scalar one")
      ->type_name("NAME");
  c.app->add_option("--iso", s.volume.iso, "value on a volume's surface; default: 0 (level set), 0.5 (fog)")
      ->type_name("V");
  c.app
      ->add_option("--adaptivity", s.volume.adaptivity,
                   "0 to 1: merge a volume's cells whose normals differ by less; default 0: none")
      ->type_name("A")
      ->check(CLI::Range(0.0, 1.0));
  add_terrain(c.app, s.terrain);
  c.app->add_flag("!--no-normals", s.make_normals, "do not compute normals where the input has none");
  c.app->add_flag("--incremental", s.incremental,
                  "keep what was simplified, in FILE.cells, and use what is there: after a change of some\n"
                  "inputs only what they touch is done, with the same result (terrain: choose --origin)");
  c.app->add_flag("--force", s.force, "build also when the output is up to date");
  add_threads(c.app, common);
  add_quiet(c.app, s.quiet);
  c.runs(common, run_build);
  c.app->parse_complete_callback([settings = c.settings] {
    if (settings->inputs.size() > 1 && settings->output.empty())
      throw CLI::RequiredError("-o FILE, as there is more than one INPUT,");
  });
}

void add_info(CLI::App& program, Common& common) {
  Command<InfoSettings> c(
      program, "info", "Tells what is in a .cuesta file.",
      "Bounds, counts, grid, attributes, and for each round its pages and the range of its\n"
      "errors in world units. Of a scene: nodes, instances, parts, clips, and how much of it is in each\n"
      "layer of segments, coarsest first.\n\n"
      "Example:\n  cuesta info bunny.cuesta --json");
  InfoSettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file")->required();
  c.app->add_flag("--json", s.json, "as JSON with stable keys");
  c.app->add_flag("--pages,--parts", s.pages,
                  "also one line (one object) for each page; of a scene, for each part");
  c.runs(common, run_info);
}

/// What render and view have in common, with the words for their defaults.
struct BudgetDefaults {
  const char *adapt, *upload, *threads, *geomorph;
};
template <class Settings>
void add_render_budgets(CLI::App* app, Settings& s, const BudgetDefaults& defaults) {
  app->add_option("--tau", s.tau_px, "screen-space error to aim at, in pixels; default 1")
      ->type_name("PX")
      ->check(CLI::NonNegativeNumber);
  add_parsed(app, "--triangles", "N", "never more triangles than this, such as 500k or 1M; default: no limit",
             store(parse_count, s.budgets.triangles));
  app->add_option("--adapt-ms", s.budgets.adapt_ms,
                  std::string("time for changing the cut in a frame; default: ") + defaults.adapt)
      ->type_name("MS")
      ->check(CLI::NonNegativeNumber);
  app->add_option("--page-loads", s.budgets.page_loads, "pages asked for in a frame; default: no limit")
      ->type_name("N");
  add_parsed(app, "--upload", "SIZE",
             std::string("vertices and indices that change in a frame; default: ") + defaults.upload,
             store(parse_bytes, s.budgets.upload_bytes));
  app->add_option(
         "--geomorph", s.geomorph_ms,
         std::string("length of blends between levels, near the eye; 0: none; default: ") + defaults.geomorph)
      ->type_name("MS")
      ->check(CLI::Range(0.0, 60000.0));
  app->add_option("--load-threads", s.load_threads,
                  std::string("that read pages; 0: frames wait for them; default: ") + defaults.threads)
      ->type_name("N")
      ->check(CLI::Range(0u, 64u));
  add_parsed(app, "--cache", "SIZE", "memory for resident pages; default 1G",
             store(parse_bytes, s.cache_bytes));
  app->add_option("--visual", s.visual_factor,
                  "how much coarser what faces the eye may be, silhouettes stay; default 1: not at all")
      ->type_name("F")
      ->check(CLI::Range(1.0, 1e6));
  app->add_option("--outside", s.outside_factor,
                  "how much coarser what is outside the picture may be; default 4")
      ->type_name("F")
      ->check(CLI::Range(1.0, 1e6));
}

void add_exaggerate(CLI::App* app, double& factor) {
  app->add_option("--exaggerate", factor, "draw a terrain's heights F times as high; default 1")
      ->type_name("F")
      ->check(CLI::Range(0.01, 100.0));
}

template <class Settings>
void add_look(CLI::App* app, Settings& s) {
  DrawOptions& draw = s.draw;
  const std::map<std::string, Shading> shadings{
      {"lit", Shading::lit},         {"wireframe", Shading::wireframe}, {"normals", Shading::normals},
      {"changes", Shading::changes}, {"pages", Shading::pages},         {"relief", Shading::relief}};
  add_parsed(app, "--shading", "HOW",
             "lit, wireframe, normals, changes (coarse path grey, fine path dark), pages or relief\n"
             "(colours of heights, or a draped image); default: relief for terrain, else lit",
             [shadings, &s](const std::string& text) {
               const auto at = shadings.find(text);
               if (at != shadings.end()) s.shading = at->second;
               return at != shadings.end();
             });
  add_exaggerate(app, s.exaggeration);
  app->add_flag("--page-borders", draw.page_borders, "red lines where pages meet");
  add_parsed(app, "--background", "COLOUR", "#rrggbb, white, black, grey or transparent; default white",
             store(parse_colour, draw.background));
  add_parsed(app, "--colour", "COLOUR", "of the surface, times its vertices' colours; default warm grey",
             store(parse_colour, draw.surface_colour));
}

template <class Settings>
void add_deadline(CLI::App* app, Settings& s) {
  const char* group = "Scenes";
  add_parsed(
      app, "--policy", "HOW",
      "resolutions of objects, frame by frame: predictive (the best that the deadline allows), stress\n"
      "(follows what past frames took) or static (by size in the picture); default predictive",
      one_of<PolicyKind>({{"predictive", PolicyKind::predictive},
                          {"stress", PolicyKind::stress},
                          {"static", PolicyKind::fixed}},
                         s.policy))
      ->group(group);
  app->add_option("--deadline-ms", s.deadline_ms, "time of a frame; default 33")
      ->type_name("MS")
      ->check(CLI::Range(0.1, 1e6))
      ->group(group);
}

void add_render(CLI::App& program, Common& common) {
  Command<RenderSettings> c(
      program, "render", "Renders pictures of a .cuesta file.",
      "Without a camera: the whole model, seen from the front, a little from the right and above;\n"
      "terrain from the south. A globe seen as a whole shows its coasts at --tau 0.05 or less: heights\n"
      "are far below a pixel there.\n"
      "A flight writes frame-00000.png …, frames.csv (statistics of each frame) and frames.svg (their\n"
      "plot) into the output folder. Its first frame is settled; then each frame adapts once, within\n"
      "the budgets, and what is left undone goes on in the next. With --video, PNGs are written only\n"
      "where -o names a folder.\n\n"
      "A scene's flight holds a deadline: resolutions of objects are chosen so that each frame takes no\n"
      "longer, and its first clip plays. What drawing costs is measured before the first frame.\n\n"
      "Examples:\n  cuesta render bunny.cuesta -o bunny.png\n"
      "  cuesta render bunny.cuesta --orbit 240 --video bunny.mp4\n"
      "  cuesta render bunny.cuesta --camera \"eye 0,0.1,0.3 target 0,0.1,0\" --tau 0.5 --size 1920x1080\n"
      "  cuesta render bunny.cuesta --flight flight.json --adapt-ms 4 --triangles 50000 -o frames\n"
      "  cuesta render engine.cuesta --orbit 240 --deadline-ms 16 -o frames");
  RenderSettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file")->required();
  add_path(c.app, "-o,--output", s.output, "PNG, or a folder for a flight; default: named after FILE");
  auto* camera = add_camera(c.app, s.camera);
  auto* orbit = c.app->add_option("--orbit", s.orbit_frames, "once around the model in N frames")
                    ->type_name("N")
                    ->check(CLI::Range(2u, 100000u));
  auto* flight = add_path(c.app, "--flight", s.flight, "frames of a flight file (see cuesta flight)");
  auto* video =
      add_path(c.app, "--video", s.video, "a flight's frames as .mp4 or .webm, by an installed ffmpeg");
  video->excludes(camera);
  camera->excludes(orbit)->excludes(flight);
  orbit->excludes(flight);
  add_camera_frame(c.app, s.view, &s.up_given);
  add_render_budgets(c.app, s, {"no limit", "no limit", "0", "0"});
  add_look(c.app, s);
  add_parsed(c.app, "--context", "HOW",
             "egl (a GPU without a screen), osmesa (no GPU at all) or auto: egl where it works; default auto",
             one_of<OffscreenContext>({{"auto", OffscreenContext::automatic},
                                       {"egl", OffscreenContext::egl},
                                       {"osmesa", OffscreenContext::osmesa}},
                                      s.context));
  add_deadline(c.app, s);
  c.app->add_flag("--settle", s.settle, "settle each frame of a flight: only the triangle budget then binds");
  c.app->add_flag("--stats-only", s.stats_only, "draw nothing: frames.csv and frames.svg only");
  add_quiet(c.app, s.quiet);
  c.runs(common, run_render);
  c.app->parse_complete_callback([orbit, flight, video] {
    if (!video->empty() && orbit->empty() && flight->empty())
      throw CLI::RequiredError("--orbit or --flight, with --video,");
  });
}

void add_view(CLI::App& program, Common& common) {
  Command<ViewSettings> c(
      program, "view", "Shows .cuesta files in a window.",
      "Several files are shown in one world, as they are; more can be dropped on the window. F1 shows what\n"
      "mouse and keys do: orbit (1), fly (2) and walk (3), tau, budgets, debug colours, pictures, flights.\n"
      "Pictures and flights are saved in this folder, a flight with a .csv of its frames. Ctrl-C saves one\n"
      "that is being recorded.\n\n"
      "Each frame adapts once within the budgets; a still picture takes no time.\n\n"
      "A scene is shown by itself, each frame within its deadline: policy (V) and deadline (; ') can be\n"
      "changed, its clips played (M, O), and parts moved, by dragging them with Ctrl.\n\n"
      "Without a display: cuesta render.\n\n"
      "Examples:\n  cuesta view bunny.cuesta\n"
      "  cuesta view scan.cuesta --triangles 1000000 --cache 4G --size 1920x1080\n"
      "  cuesta view bunny.cuesta --flight zoom.json --screenshot end.png --exit");
  ViewSettings& s = *c.settings;
  c.app->add_option("FILE", s.files, ".cuesta files")->type_name("");
  add_camera(c.app, s.camera);
  add_camera_frame(c.app, s.view, &s.up_given);
  c.app->add_flag("--full-screen", s.full_screen, "begin in full screen");
  add_render_budgets(c.app, s, {"4", "16M", "2", "250"});
  add_look(c.app, s);
  add_deadline(c.app, s);
  add_path(c.app, "--flight", s.flight, "flight to play at the start (see cuesta flight)");
  c.app->add_option("--press", s.press, "keys to press at the start: names such as \"2 x f6\"")
      ->type_name("KEYS");
  add_path(c.app, "--screenshot", s.screenshot, "PNG of the picture once it has settled, after the flight");
  c.app->add_flag("--exit", s.exit, "close the window then");
  c.runs(common, run_view);
}

void add_flight(CLI::App& program, Common& common) {
  Command<FlightSettings> c(
      program, "flight", "Writes a flight file around a model, for render --flight.",
      "The file is JSON: {\"fps\": 30, \"keyframes\": [{\"t\": 0, \"eye\": [x,y,z],\n"
      "\"target\": [x,y,z], \"up\": [x,y,z], \"fov_deg\": 60}, …]}; t in seconds. Eye and target\n"
      "move on Catmull–Rom splines through the keyframes.\n\n"
      "Terrain has its own up, and fly-over follows its ground, at a height above it, along a route;\n"
      "without one, along the longer side of its bounds.\n\n"
      "A scene's walk-through goes around it, into its middle, turns there abruptly, and comes out.\n\n"
      "Examples:\n  cuesta flight bunny.cuesta --kind zoom-in --frames 120 -o zoom.json\n"
      "  cuesta flight engine.cuesta --kind walk-through --frames 300 -o walk.json\n"
      "  cuesta flight alps.cuesta --kind fly-over --route 46.0 7.6 46.5 8.0 --height 800 -o alps.json");
  FlightSettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file")->required();
  add_path(c.app, "-o,--output", s.output, "flight file to write")->required();
  add_parsed(c.app, "--kind", "KIND", "orbit, zoom-in, fly-over or walk-through (of scenes); default orbit",
             one_of<FlightKind>({{"orbit", FlightKind::orbit},
                                 {"zoom-in", FlightKind::zoom_in},
                                 {"fly-over", FlightKind::fly_over},
                                 {"walk-through", FlightKind::walk_through}},
                                s.kind));
  auto* frames = c.app->add_option("--frames", s.frames, "number of frames; default 300")
                     ->type_name("N")
                     ->check(CLI::Range(2u, 1000000u));
  add_parsed(c.app, "--speed", "SPEED", "slow, medium or fast: the way in 100, 50 or 10 frames",
             one_of<std::uint64_t>({{"slow", 100}, {"medium", 50}, {"fast", 10}}, s.frames))
      ->excludes(frames);
  c.app->add_option("--fps", s.fps, "frames per second; default 30")
      ->type_name("F")
      ->check(CLI::Range(1.0, 1000.0));
  add_camera_frame(c.app, s.view, &s.up_given);
  c.app->add_option("--route", s.route, "of a terrain, for fly-over: places LAT LON, two or more")
      ->type_name("…");
  c.app
      ->add_option("--height", s.above_ground_m,
                   "above ground, for fly-over; default: 2 % of the route's length")
      ->type_name("METRES")
      ->check(CLI::PositiveNumber);
  add_exaggerate(c.app, s.exaggeration);
  c.runs(common, run_flight);
}

void add_tile_options(CLI::App* app, ExportSettings& s) {
  app->add_option("--tile-triangles", s.tile_triangles, "3dtiles: at most so many in a tile; default 65535")
      ->type_name("N")
      ->check(CLI::Range(64u, 1u << 22));
  app->add_option("--border", s.border_share,
                  "3dtiles: error along borders between tiles, as a share of the tile's; default 0.25")
      ->type_name("SHARE")
      ->check(CLI::Range(1.0 / 1024, 1.0));
}

void add_export(CLI::App& program, Common& common) {
  Command<ExportSettings> c(
      program, "export", "Writes a .cuesta file as a mesh, or as tiles for web maps and engines.",
      "A mesh is uniform: by error, by triangle count, or in full. Or of a view: with --camera and --tau.\n"
      "Tells the triangles and the guaranteed error: no vertex of the input is farther from the mesh.\n"
      "Tiles have all levels of detail. 3dtiles (3D Tiles 1.1, for CesiumJS, three.js, Unreal, Unity, QGIS)\n"
      "become a folder with tileset.json, or one archive where the output ends in .3tz. quantized-mesh\n"
      "(terrain for CesiumJS) becomes a folder with layer.json; --error is that of its last level.\n"
      "\n"
      "Examples:\n  cuesta export bunny.cuesta -o small.ply --triangles 5000\n"
      "  cuesta export bunny.cuesta -o near.glb --camera \"eye 0,0.1,0.3 target 0,0.1,0\" --tau 1\n"
      "  cuesta export engine.cuesta --node crankshaft --full -o crankshaft.glb\n"
      "  cuesta export alps.cuesta --format 3dtiles -o alps-tiles\n"
      "  cuesta export scan.cuesta -o scan.3tz\n"
      "  cuesta export alps.cuesta --format quantized-mesh -o alps-terrain");
  ExportSettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file")->required();
  add_path(c.app, "-o,--output", s.output, "mesh (.ply, .obj, .glb), archive (.3tz) or folder to write")
      ->required();
  add_parsed(c.app, "--format", "FORMAT",
             "3dtiles, quantized-mesh, ply, obj or glb; default: what the output's name says",
             one_of<ExportFormat>({{"3dtiles", ExportFormat::tiles_3d},
                                   {"quantized-mesh", ExportFormat::quantized_mesh},
                                   {"ply", ExportFormat::ply},
                                   {"obj", ExportFormat::obj},
                                   {"glb", ExportFormat::glb}},
                                  s.format));
  add_tile_options(c.app, s);
  auto* error =
      add_parsed(c.app, "--error", "E", "largest deviation, in world units", [&s](const std::string& text) {
        double value = 0;
        if (!CLI::detail::lexical_cast(text, value) || !(value >= 0)) return false;
        s.error = value;
        return true;
      });
  auto* triangles = add_parsed(c.app, "--triangles", "N", "the best mesh of at most N triangles",
                               [&s](const std::string& text) {
                                 const auto count = parse_count(text);
                                 if (count) s.triangles = *count;
                                 return count.has_value();
                               });
  auto* full = c.app->add_flag("--full", s.full, "everything, at full resolution");
  auto* camera = add_camera(c.app, s.camera);
  auto* node =
      c.app
          ->add_option("--node", s.node, "of a scene: nodes of this name, and all below them, where they are")
          ->type_name("NAME");
  c.app->add_option("--part", s.part, "of a scene: the part of this name, in its own frame")
      ->type_name("NAME")
      ->excludes(node);
  error->excludes(camera)->excludes(full);
  full->excludes(camera)->excludes(triangles);
  c.app->add_option("--tau", s.tau_px, "with --camera: screen-space error in pixels; default 1")
      ->type_name("PX")
      ->check(CLI::NonNegativeNumber)
      ->needs(camera);
  c.app
      ->add_option("--outside", s.outside_factor,
                   "with --camera: how much coarser outside the picture; default 1")
      ->type_name("F")
      ->check(CLI::Range(1.0, 1e6))
      ->needs(camera);
  add_camera_frame(c.app, s.view);
  add_parsed(c.app, "--cache", "SIZE", "memory for resident pages; default: half of the machine's",
             store(parse_bytes, s.cache_bytes));
  c.app->add_flag("--json", s.json, "tell triangles and bounds as JSON with stable keys");
  add_quiet(c.app, s.quiet);
  c.runs(common, run_export);
  c.app->parse_complete_callback([error, triangles, full, camera, &s] {
    if (format_of(s) == ExportFormat::tiles_3d || format_of(s) == ExportFormat::quantized_mesh) return;
    if (error->empty() && triangles->empty() && full->empty() && camera->empty())
      throw CLI::RequiredError("One of --error, --triangles, --full and --camera");
  });
}

void add_sample(CLI::App& program, Common& common) {
  Command<SampleSettings> c(
      program, "sample", "Tells how high a terrain is at places.",
      "From the finest data, linear on the triangles of the original surface; only the pages that\n"
      "lie there are read. Places are pairs LAT LON in degrees (WGS 84), or X Y with --xy.\n\n"
      "Examples:\n  cuesta sample alps.cuesta 45.8326 6.8652\n"
      "  cuesta sample alps.cuesta --xy --crs EPSG:32632 334000 5078000\n"
      "  cuesta sample alps.cuesta --from summits.txt --json");
  SampleSettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file that was built from heights")->required();
  auto* points = c.app->add_option("LAT LON", s.points, "places, any number of them")->type_name("");
  auto* from = add_path(c.app, "--from", s.from, "places, a pair a line; -: standard input");
  auto* xy = c.app->add_flag("--xy", s.xy, "places are coordinates x and y of a projection");
  c.app->add_option("--crs", s.crs, "with --xy: which projection, as EPSG:n; default: the file's own")
      ->type_name("NAME")
      ->needs(xy);
  c.app->add_flag("--json", s.json, "as JSON with stable keys");
  c.runs(common, run_sample);
  c.app->parse_complete_callback([points, from] {
    if (points->empty() && from->empty()) throw CLI::RequiredError("LAT LON, or --from FILE,");
  });
}

void add_serve(CLI::App& program, Common& common) {
  Command<ServeSettings> c(
      program, "serve", "Serves .cuesta files over HTTP.",
      "A start page with pictures, facts as JSON (/api/datasets), and the files themselves, in ranges\n"
      "(/data/NAME.cuesta). Tiles of them as 'cuesta export' writes them, made when they are asked for:\n"
      "3D Tiles (/tiles/NAME/tileset.json), and quantized-mesh of terrain (/terrain/NAME/layer.json).\n"
      "/healthz and /metrics for those who run it. Files may appear, be replaced and disappear meanwhile:\n"
      "it looks every second. Nothing outside PATH can be read; links in it are not followed. There is no\n"
      "encryption: put a reverse proxy in front (docs/serving.md).\n\n"
      "Ctrl-C ends the responses under way, and then the server.\n\n"
      "Examples:\n  cuesta serve scans/\n"
      "  cuesta serve alps.cuesta dragon.cuesta --bind 0.0.0.0 --port 80");
  ServeSettings& s = *c.settings;
  c.app->add_option("PATH", s.paths, ".cuesta files, and folders that are searched for them")
      ->type_name("")
      ->required();
  c.app->add_option("--port", s.port, "default 8080; 0: any that is free")->type_name("N");
  c.app
      ->add_option("--bind", s.bind,
                   "address to listen at: 0.0.0.0 or :: for all; default 127.0.0.1, this machine")
      ->type_name("ADDRESS");
  c.app->add_option("--threads", s.threads, "threads that serve; default: the machine's, at most 16")
      ->type_name("N")
      ->check(CLI::Range(1u, 256u));
  c.app->add_option("--connections", s.connections, "that are open at once; default 1024")
      ->type_name("N")
      ->check(CLI::Range(1u, 1'000'000u));
  add_path(c.app, "--page", s.page, "folder with a built web page, served at /view/")->type_name("DIR");
  c.app
      ->add_option("--sessions", s.sessions,
                   "view-dependent sessions that are open at once; default 256; 0: none")
      ->type_name("N")
      ->check(CLI::Range(0u, 100'000u));
  add_parsed(c.app, "--session-cache", "SIZE", "memory for the pages of each session; default 64M",
             store(parse_bytes, s.session_cache_bytes));
  add_parsed(c.app, "--session-memory", "SIZE",
             "memory for all sessions together, beyond which they are refused: each takes up to twice its\n"
             "--session-cache; default half of the machine's",
             store(parse_bytes, s.session_memory_bytes));
  c.app->add_option("--tile-threads", s.tile_threads, "threads that make tiles; default 2; 0: no tiles")
      ->type_name("N")
      ->check(CLI::Range(0u, 256u));
  add_parsed(c.app, "--tile-cache", "SIZE",
             "memory for the pages that tiles are made of, for each such thread; default 512M",
             store(parse_bytes, s.tile_cache_bytes));
  add_parsed(c.app, "--tile-memory", "SIZE", "memory for tiles that were made; default 128M",
             store(parse_bytes, s.tile_memory_bytes));
  c.app->add_flag("!--no-thumbnails", s.thumbnails, "the start page has no pictures");
  c.runs(common, run_serve);
}

void add_verify(CLI::App& program, Common& common) {
  Command<VerifySettings> c(
      program, "verify", "Checks a .cuesta file: bytes, structure, invariants.",
      "Replays every page and checks that each substitution is legal and its error and sphere\n"
      "contain those it depends on; then looks at sample cuts: no cracks, and the reported error\n"
      "bounds the distance of every original vertex. Exit status 3 if anything was found.\n\n"
      "Example:\n  cuesta verify bunny.cuesta");
  VerifySettings& s = *c.settings;
  add_path(c.app, "FILE", s.file, "a .cuesta file")->required();
  c.app->add_flag("--quick", s.quick, "no sample cuts");
  c.app->add_flag("--json", s.json, "as JSON with stable keys");
  add_threads(c.app, common);
  add_quiet(c.app, s.quiet);
  c.runs(common, run_verify);
}

void add_measure(CLI::App& program, Common& common) {
  Command<MeasureSettings> c(
      program, "measure", "Measures how far two surfaces are apart.",
      "Samples each surface evenly over its area and takes distances to the other (Cignoni,\n"
      "Rocchini, Scopigno: Metro, 1998). Maxima also look at every vertex. A is the original:\n"
      "per cent are of its bounding box's diagonal.\n\n"
      "Example:\n  cuesta measure bunny.ply small.ply --samples 500000");
  MeasureSettings& s = *c.settings;
  add_path(c.app, "A", s.a, "the original: a mesh file")->required();
  add_path(c.app, "B", s.b, "the other mesh file")->required();
  c.app->add_option("--samples", s.samples, "samples in each direction; default 1000000")
      ->type_name("N")
      ->check(CLI::Range(1ull, 1ull << 34));
  add_parsed(c.app, "--memory", "SIZE", "memory for reading each mesh; default: 3/4 of the machine's",
             store(parse_bytes, s.memory_bytes));
  c.app->add_flag("--json", s.json, "as JSON with stable keys");
  add_threads(c.app, common);
  add_quiet(c.app, s.quiet);
  c.runs(common, run_measure);
}

/// The words of CLI11 on the right stream, and our exit status for them.
int end_of_parse(const CLI::App& program, const CLI::ParseError& e) {
  return program.exit(e) == 0 ? 0 : wrong_usage;
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App program("Cuesta: gigantic triangle meshes in one file that can be flown through.", "cuesta");
  Common common;
  program.require_subcommand(1);
  program.set_version_flag("--version", version_text());
  program.footer(std::string("cuesta COMMAND --help tells about a command, with an example.\n") +
                 exit_statuses);
  add_build(program, common);
  add_info(program, common);
  add_render(program, common);
  add_view(program, common);
  add_flight(program, common);
  add_export(program, common);
  add_sample(program, common);
  add_serve(program, common);
  add_verify(program, common);
  add_measure(program, common);
  const auto is_named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && std::as_const(program).get_subcommands(is_named).empty()) {
    fmt::print(stderr, "cuesta: there is no command \"{}\"; cuesta --help lists them\n", argv[1]);
    return wrong_usage;
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return end_of_parse(program, e);
  }
  std::unique_ptr<tbb::global_control> limit;
  if (common.threads > 0)
    limit =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, common.threads);
  const auto done = common.run();
  if (done) return 0;
  fmt::print(stderr, "cuesta: {}\n", done.error().text());
  return exit_status(done.error().code);
}

}  // namespace cuesta::app
