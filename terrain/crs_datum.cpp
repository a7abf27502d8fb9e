#include "terrain/crs_datum.h"

#include <algorithm>
#include <iterator>

namespace cuesta {
namespace {

constexpr Ellipsoid grs80{6378137, 298.257222101};

// clang-format off
constexpr Datum datums[] = {
    {3824, 1026, "TWD97", grs80, 2},
    {4019, 6019, "Unknown datum based upon the GRS 1980 ellipsoid", grs80, -1},
    {4030, 6030, "Unknown datum based upon the WGS 84 ellipsoid", wgs84_ellipsoid, -1},
    {4148, 6148, "Hartebeesthoek94", wgs84_ellipsoid, 1},
    {4151, 6151, "CHTRS95", grs80, 1},
    {4152, 6152, "NAD83(HARN)", grs80, 2},
    {4167, 6167, "NZGD2000", grs80, 2},
    {4170, 6170, "SIRGAS 1995", grs80, 1},
    {4171, 6171, "RGF93 v1", grs80, 1},
    {4173, 6173, "IRENET95", grs80, 1},
    {4180, 6180, "EST97", grs80, 1},
    {4190, 6190, "POSGAR 98", grs80, 1},
    {4258, 6258, "ETRS89", grs80, 1},
    {4269, 6269, "NAD83", grs80, 2},
    {4283, 6283, "GDA94", grs80, 2},
    {4326, 6326, "WGS 84", wgs84_ellipsoid, 0},
    {4463, 1038, "RGSPM06", grs80, 1},
    {4470, 1036, "RGM04", grs80, 1},
    {4483, 1042, "Mexico ITRF92", grs80, 1},
    {4490, 1043, "China Geodetic Coordinate System 2000", grs80, 1},
    {4558, 1047, "RRAF 1991", grs80, 2},
    {4612, 6612, "JGD2000", grs80, 6},
    {4617, 6140, "NAD83(CSRS)", grs80, 2},
    {4619, 6619, "SWEREF99", grs80, 1},
    {4624, 6624, "RGFG95", grs80, 1},
    {4627, 6627, "RGR92", grs80, 1},
    {4659, 6659, "ISN93", grs80, 1},
    {4661, 6661, "LKS92", grs80, 1},
    {4669, 6126, "LKS94", grs80, 1},
    {4670, 6670, "IGM95", grs80, 1},
    {4674, 6674, "SIRGAS 2000", grs80, 1},
    {4686, 6686, "MAGNA-SIRGAS", grs80, 1},
    {4687, 6687, "RGPF", grs80, 2},
    {4737, 6737, "Korea 2000", grs80, 1},
    {4747, 6747, "GR96", grs80, 1},
    {4749, 6749, "RGNC91-93", grs80, 2},
    {4755, 6755, "DGN95", wgs84_ellipsoid, 3},
    {4759, 6759, "NAD83(NSRS2007)", grs80, 2},
    {4761, 6761, "HTRS96", grs80, 1},
    {4765, 6765, "Slovenia 1996", grs80, 1},
    {5252, 1057, "TUREF", grs80, 1},
    {5324, 1060, "ISN2004", grs80, 1},
    {5340, 1062, "POSGAR 2007", wgs84_ellipsoid, 1},
    {5489, 1073, "RGAF09", grs80, 2},
    {6318, 1116, "NAD83(2011)", grs80, 2},
    {6322, 1117, "NAD83(PA11)", grs80, 2},
    {6325, 1118, "NAD83(MA11)", grs80, 2},
    {6365, 1120, "Mexico ITRF2008", grs80, 1},
    {6668, 1128, "JGD2011", grs80, 2},
    {6706, 1132, "RDN2008", grs80, 1},
    {6783, 1133, "NAD83(CORS96)", grs80, 2},
    {7798, 1167, "BGS2005", grs80, 1},
    {7844, 1168, "GDA2020", grs80, 1},
    {8086, 1187, "ISN2016", grs80, 1},
    {8999, 1061, "ITRF2008", grs80, 1},
    {9000, 1165, "ITRF2014", grs80, 1},
    {9333, 1268, "KSA-GRF17", grs80, 1},
    {9470, 1293, "SRGI2013", wgs84_ellipsoid, 2},
    {9702, 1305, "ETRF2000-PL", grs80, 1},
    {9777, 1312, "RGF93 v2", grs80, 1},
    {9782, 1313, "RGF93 v2b", grs80, 1},
};

struct RefusedDatum {
  int geographic_epsg, datum_epsg;
  const char* name;
};
constexpr RefusedDatum refused[] = {
    {4035, 6035, "Unknown datum based upon the Authalic Sphere"},
    {4047, 6047, "Unspecified datum based upon the GRS 1980 Authalic Sphere"},
    {4052, 6052, "Unspecified datum based upon the Clarke 1866 Authalic Sphere"},
    {4053, 6053, "Unspecified datum based upon the International 1924 Authalic Sphere"},
    {4054, 6054, "Unspecified datum based upon the Hughes 1980 ellipsoid"},
    {4121, 6121, "GGRS87"},
    {4123, 6123, "KKJ"},
    {4124, 6124, "RT90"},
    {4135, 6135, "Old Hawaiian"},
    {4141, 6141, "Israel 1993"},
    {4149, 6149, "CH1903"},
    {4150, 6150, "CH1903+"},
    {4156, 6156, "S-JTSK"},
    {4179, 6179, "Pulkovo 1942(58)"},
    {4200, 6200, "Pulkovo 1995"},
    {4202, 6202, "AGD66"},
    {4203, 6203, "AGD84"},
    {4209, 6209, "Arc 1950"},
    {4209, 6209, "Arc 1950"},
    {4210, 6210, "Arc 1960"},
    {4214, 6214, "Beijing 1954"},
    {4218, 6218, "Bogota 1975"},
    {4222, 6222, "Cape"},
    {4225, 6225, "Corrego Alegre 1970-72"},
    {4229, 6229, "Egypt 1907"},
    {4230, 6230, "ED50"},
    {4231, 6231, "ED87"},
    {4237, 6237, "HD72"},
    {4240, 6240, "Indian 1975"},
    {4248, 6248, "PSAD56"},
    {4265, 6265, "Monte Mario"},
    {4267, 6267, "NAD27"},
    {4272, 6272, "NZGD49"},
    {4275, 6275, "NTF"},
    {4277, 6277, "OSGB36"},
    {4284, 6284, "Pulkovo 1942"},
    {4289, 6289, "Amersfoort"},
    {4298, 6298, "Timbalai 1948"},
    {4299, 6299, "TM65"},
    {4300, 6300, "TM75"},
    {4301, 6301, "Tokyo"},
    {4312, 6312, "MGI"},
    {4313, 6313, "BD72"},
    {4314, 6314, "DHDN"},
    {4322, 6322, "WGS 72"},
    {4610, 6610, "Xian 1980"},
    {4611, 6611, "Hong Kong 1980"},
    {4618, 6618, "SAD69"},
    {4751, 6751, "Kertau (RSO)"},
    {4756, 6756, "VN-2000"},
    {4757, 6757, "SVY21"},
    {4805, 6805, "MGI (Ferro)"},
    {4807, 6807, "NTF (Paris)"},
};
// clang-format on

/// Systems with height as third coordinate, and the one without of the same datum.
constexpr int with_height[][2] = {{4979, 4326}, {4937, 4258}, {4957, 4152}, {4893, 4759},
                                  {6319, 6318}, {4955, 4617}, {4939, 4283}, {7843, 7844},
                                  {4959, 4167}, {4947, 4612}, {6667, 6668}, {4989, 4674},
                                  {4480, 4490}, {4965, 4171}, {4977, 4619}, {7912, 9000}};

int without_height(int geographic_epsg) {
  for (const auto& pair : with_height) {
    if (pair[0] == geographic_epsg) return pair[1];
  }
  return geographic_epsg;
}

}  // namespace

const Datum* find_datum(int geographic_epsg) {
  const int code = without_height(geographic_epsg);
  const auto found = std::ranges::find(datums, code, &Datum::geographic_epsg);
  return found == std::end(datums) ? nullptr : &*found;
}

const Datum* find_datum_by_code(int datum_epsg) {
  const auto found = std::ranges::find(datums, datum_epsg, &Datum::datum_epsg);
  return found == std::end(datums) ? nullptr : &*found;
}

const Ellipsoid* find_ellipsoid(int ellipsoid_epsg) {
  if (ellipsoid_epsg == 7030) return &wgs84_ellipsoid;
  return ellipsoid_epsg == 7019 || ellipsoid_epsg == 1024 ? &grs80 : nullptr;
}

bool is_geographic_3d(int geographic_epsg) {
  return without_height(geographic_epsg) != geographic_epsg;
}

const char* refused_datum(int geographic_epsg) {
  const auto found = std::ranges::find(refused, geographic_epsg, &RefusedDatum::geographic_epsg);
  return found == std::end(refused) ? nullptr : found->name;
}

const char* refused_datum_by_code(int datum_epsg) {
  const auto found = std::ranges::find(refused, datum_epsg, &RefusedDatum::datum_epsg);
  return found == std::end(refused) ? nullptr : found->name;
}

std::string datum_refusal(const std::string& datum) {
  return "datum " + datum +
         " is not WGS 84 to within metres, and shifts of datum are not supported; reproject the raster to "
         "WGS 84 "
         "(EPSG:4326) first";
}

}  // namespace cuesta
