#pragma once
/// Gradient noise in the plane, row by row: what a cell of its lattice needs is computed once for all
/// postings in it. Source: K. Perlin, "Improving Noise", SIGGRAPH 2002; ridges by absolute value after F. K.
/// Musgrave, in Ebert et al., "Texturing and Modeling", 2003, ch. 16. Deviation: eight gradients, chosen by a
/// hash of (cell, seed).

#include <cstdint>
#include <span>

namespace cuesta::tools {

/// out[i] = noise at (i / wavelength, row / wavelength), in [-1, 1], zero at lattice points, where it has
/// been moved by an amount of the seed's. The same on every machine.
/// @param wavelength  side of a cell in postings, > 0.   @cost about 3 ns per posting and 10 ns per cell.
void gradient_noise_row(std::span<double> out, std::uint64_t row, double wavelength, std::uint64_t seed);

/// out[i] = sum of octaves: wavelength, wavelength / 2, … down to `shortest`, with amplitudes 1, 1/2, …; half
/// of each is noise as it is, half is its ridges, with a mean near 0. |out| < 2.
void fractal_row(std::span<double> out, std::uint64_t row, double wavelength, double shortest,
                 std::uint64_t seed);

}  // namespace cuesta::tools
