#include "terrain/crs_epsg_table.h"

namespace cuesta {
namespace {

// clang-format off
constexpr EpsgRefused refused[] = {
    {2039, "Israel 1993 / Israeli TM Grid", "", "Israel 1993"},
    {2056, "CH1903+ / LV95", "Hotine Oblique Mercator (variant B)", "CH1903+"},
    {2100, "GGRS87 / Greek Grid", "", "GGRS87"},
    {2326, "Hong Kong 1980 Grid System", "", "Hong Kong 1980"},
    {2393, "KKJ / Finland Uniform Coordinate System", "", "KKJ"},
    {3003, "Monte Mario / Italy zone 1", "", "Monte Mario"},
    {3004, "Monte Mario / Italy zone 2", "", "Monte Mario"},
    {3021, "RT90 2.5 gon V", "", "RT90"},
    {3035, "ETRS89-extended / LAEA Europe", "Lambert Azimuthal Equal Area", "ETRS89"},
    {3168, "Kertau (RSO) / RSO Malaya (m)", "Hotine Oblique Mercator (variant A)", "Kertau (RSO)"},
    {3375, "GDM2000 / Peninsula RSO", "Hotine Oblique Mercator (variant A)", "GDM2000"},
    {3408, "NSIDC EASE-Grid North", "Lambert Azimuthal Equal Area (Spherical)", "Unspecified datum based upon the International 1924 Authalic Sphere"},
    {3409, "NSIDC EASE-Grid South", "Lambert Azimuthal Equal Area (Spherical)", "Unspecified datum based upon the International 1924 Authalic Sphere"},
    {3410, "NSIDC EASE-Grid Global", "Lambert Cylindrical Equal Area (Spherical)", "Unspecified datum based upon the International 1924 Authalic Sphere"},
    {3411, "NSIDC Sea Ice Polar Stereographic North", "", "Unspecified datum based upon the Hughes 1980 ellipsoid"},
    {3412, "NSIDC Sea Ice Polar Stereographic South", "", "Unspecified datum based upon the Hughes 1980 ellipsoid"},
    {3414, "SVY21 / Singapore TM", "", "SVY21"},
    {3571, "WGS 84 / North Pole LAEA Bering Sea", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3572, "WGS 84 / North Pole LAEA Alaska", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3573, "WGS 84 / North Pole LAEA Canada", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3574, "WGS 84 / North Pole LAEA Atlantic", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3575, "WGS 84 / North Pole LAEA Europe", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3576, "WGS 84 / North Pole LAEA Russia", "Lambert Azimuthal Equal Area", "WGS 84"},
    {3844, "Pulkovo 1942(58) / Stereo70", "Oblique Stereographic", "Pulkovo 1942(58)"},
    {4087, "WGS 84 / World Equidistant Cylindrical", "Equidistant Cylindrical", "WGS 84"},
    {4088, "World Equidistant Cylindrical (Sphere)", "Equidistant Cylindrical (Spherical)", "Unspecified datum based upon the GRS 1980 Authalic Sphere"},
    {5069, "NAD27 / Conus Albers", "", "NAD27"},
    {5513, "S-JTSK / Krovak", "Krovak", "S-JTSK"},
    {5514, "S-JTSK / Krovak East North", "Krovak (North Orientated)", "S-JTSK"},
    {5880, "SIRGAS 2000 / Brazil Polyconic", "American Polyconic", "SIRGAS 2000"},
    {6931, "WGS 84 / NSIDC EASE-Grid 2.0 North", "Lambert Azimuthal Equal Area", "WGS 84"},
    {6932, "WGS 84 / NSIDC EASE-Grid 2.0 South", "Lambert Azimuthal Equal Area", "WGS 84"},
    {6933, "WGS 84 / NSIDC EASE-Grid 2.0 Global", "Lambert Cylindrical Equal Area", "WGS 84"},
    {8857, "WGS 84 / Equal Earth Greenwich", "Equal Earth", "WGS 84"},
    {21781, "CH1903 / LV03", "Hotine Oblique Mercator (variant B)", "CH1903"},
    {22275, "Cape / Lo15", "", "Cape"},
    {23700, "HD72 / EOV", "Hotine Oblique Mercator (variant B)", "HD72"},
    {26931, "NAD83 / Alaska zone 1", "Hotine Oblique Mercator (variant A)", "NAD83"},
    {27200, "NZGD49 / New Zealand Map Grid", "New Zealand Map Grid", "NZGD49"},
    {27571, "NTF (Paris) / Lambert zone I", "", "NTF (Paris)"},
    {27572, "NTF (Paris) / Lambert zone II", "", "NTF (Paris)"},
    {27573, "NTF (Paris) / Lambert zone III", "", "NTF (Paris)"},
    {27700, "OSGB36 / British National Grid", "", "OSGB36"},
    {28992, "Amersfoort / RD New", "Oblique Stereographic", "Amersfoort"},
    {29101, "SAD69 / Brazil Polyconic", "American Polyconic", "SAD69"},
    {29873, "Timbalai 1948 / RSO Borneo (m)", "Hotine Oblique Mercator (variant B)", "Timbalai 1948"},
    {29902, "TM65 / Irish Grid", "", "TM65"},
    {29903, "TM75 / Irish Grid", "", "TM75"},
    {31287, "MGI / Austria Lambert", "", "MGI"},
    {31370, "BD72 / Belgian Lambert 72", "", "BD72"},
    {31466, "DHDN / 3-degree Gauss-Kruger zone 2", "", "DHDN"},
    {31467, "DHDN / 3-degree Gauss-Kruger zone 3", "", "DHDN"},
    {31468, "DHDN / 3-degree Gauss-Kruger zone 4", "", "DHDN"},
    {31469, "DHDN / 3-degree Gauss-Kruger zone 5", "", "DHDN"},
    {32040, "NAD27 / Texas South Central", "", "NAD27"},
};
// clang-format on

}  // namespace

std::span<const EpsgRefused> epsg_refused() {
  return refused;
}

}  // namespace cuesta
