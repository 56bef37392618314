// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/standard_atmosphere.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

// Constants of the standard, in its own values. Altitudes z in km.
constexpr double gravity_0 = 9.80665, radius = 6356.766, gas_constant = 8314.32, boltzmann_1976 = 1.380622e-23;
constexpr double ground_weight = 28.9644;  ///< kg/kmol
enum : std::size_t { n2, o2, o, ar, he };
constexpr std::array<double, 5> weight{28.0134, 31.9988, 15.9994, 39.948, 4.0026};     ///< kg/kmol
constexpr std::array<double, 5> at_ground{0.78084, 0.209476, 0, 0.00934, 0.00000524};  ///< table 3, of the molecules
constexpr std::array<double, 5> at_86{1.129794e20, 3.030898e19, 8.6e16, 1.3514e18, 7.5817e14};  ///< table 9, 1/m3

/// Tables 6 and 7: diffusion and vertical transport. N2, the background of the others, has none.
struct Transport {
  double thermal, a, b;  ///< alpha, a (1/(m s)), b
  double q, u, w;        ///< Q (1/km3), U (km), W (1/km3)
};
constexpr std::array<Transport, 5> transport{{{0, 0, 0, 0, 0, 0},
                                              {0, 4.863e20, 0.750, 1.366212e-4, 86, 8.333333e-5},
                                              {0, 6.986e20, 0.750, -5.809644e-4, 56.90311, 2.706240e-5},
                                              {0, 4.487e20, 0.870, 9.434079e-5, 86, 8.333333e-5},
                                              {-0.40, 1.700e21, 0.691, -2.457369e-4, 86, 6.666667e-4}}};

double gravity(double z) { return gravity_0 * std::pow(radius / (radius + z), 2); }

struct Temperature {
  double t, slope;  ///< K, K/km
};

/// Above 86 km: equations 25 to 31.
Temperature temperature(double z) {
  if (z <= 91) return {186.8673, 0};
  if (z <= 110) {
    constexpr double center = 263.1905, height = -76.3232, width = -19.9429;
    const double x = (z - 91) / width, root = std::sqrt(1 - x * x);
    return {center + height * root, -height * x / (width * root)};
  }
  if (z <= 120) return {240 + 12 * (z - 110), 12};
  constexpr double far = 1000, at_120 = 360, lambda = 12 / (far - at_120);
  const double part = (radius + 120) / (radius + z), rest = (far - at_120) * std::exp(-lambda * (z - 120) * part);
  return {far - rest, lambda * part * part * rest};
}

/// Coefficient of eddy diffusion, m2/s: equation 7.
double eddy_diffusion(double z) {
  if (z >= 115) return 0;
  return 120 * (z <= 95 ? 1 : std::exp(1 - 400 / (400 - (z - 95) * (z - 95))));
}

/// Velocity of a species by vertical transport over its diffusion, 1/km: equation 37.
double drift(std::size_t s, double z) {
  const auto term = [](double q, double x, double w) { return q * x * x * std::exp(-w * x * x * x); };
  const auto& c = transport[s];
  double sum = term(c.q, z - c.u, c.w);
  if (s == o && z < 97) sum += term(-3.416248e-3, 97 - z, 5.008765e-4);
  return sum;
}

using Densities = std::array<double, 5>;  ///< logarithms of density times temperature

/// Their slopes in z, 1/km: equations 36 and 38.
Densities slopes(double z, const Densities& y) {
  const auto [t, dt_dz] = temperature(z);
  Densities n{}, slope{};
  for (std::size_t s = 0; s < n.size(); ++s) n[s] = std::exp(y[s]) / t;
  const double per_weight = 1000 * gravity(z) / (gas_constant * t);  // 1/km
  const double heavy = n[n2] + n[o2] + n[o];
  const double mean = (n[n2] * weight[n2] + n[o2] * weight[o2] + n[o] * weight[o]) / heavy;
  const double eddy = eddy_diffusion(z);
  slope[n2] = -per_weight * (z <= 100 ? ground_weight : weight[n2]);
  for (const std::size_t s : {o2, o, ar, he}) {
    const bool is_oxygen = s == o2 || s == o;  // in nitrogen; the others in all three
    const double mixed = z <= 100 ? ground_weight : is_oxygen ? weight[n2] : mean;
    const auto& c = transport[s];
    const double d = c.a / (is_oxygen ? n[n2] : heavy) * std::pow(t / 273.15, c.b);
    slope[s] = -(per_weight * (d * weight[s] + eddy * mixed) + d * c.thermal * dt_dz / t) / (d + eddy) - drift(s, z);
  }
  return slope;
}

/// The fourth-order rule of Runge and Kutta, from `begin` to `end` in km.
Densities integrate(double begin, double end, Densities y) {
  const int n_steps = static_cast<int>(std::ceil((end - begin) / 0.1));
  const double h = (end - begin) / n_steps;
  const auto ahead = [](const Densities& from, double step, const Densities& slope) {
    Densities next = from;
    for (std::size_t s = 0; s < next.size(); ++s) next[s] += step * slope[s];
    return next;
  };
  for (int i = 0; i < n_steps; ++i) {
    // Slopes jump at whole kilometers, where no step may look across.
    const double z = begin + i * h, low = std::nextafter(z, end), high = std::nextafter(z + h, begin);
    const auto a = slopes(low, y), b = slopes(z + h / 2, ahead(y, h / 2, a)), c = slopes(z + h / 2, ahead(y, h / 2, b)),
               d = slopes(high, ahead(y, h, c));
    for (std::size_t s = 0; s < y.size(); ++s) y[s] += h / 6 * (a[s] + 2 * b[s] + 2 * c[s] + d[s]);
  }
  return y;
}

/// Up to 86 km.
Air mixed_air(double z) {
  // Mean molecular weight over that of the ground, at 80, 81, ... 86 km: table 8.
  constexpr std::array<double, 7> ratios{1, 0.999988, 0.999938, 0.999864, 0.999778, 0.999681, 0.999579};
  const auto k = std::min<std::size_t>(static_cast<std::size_t>(z - 80), 5);
  const double ratio = std::lerp(ratios[k], ratios[k + 1], z - 80 - static_cast<double>(k));
  const double changed = (1 - ratio) / (1 - ratios.back());
  const double molecular = 214.65 - 2 * (radius * z / (radius + z) - 71);  // temperature; geopotential altitude
  const double pressure = 3.956420 * std::pow(molecular / 214.65, gravity_0 * ground_weight / (gas_constant * 0.002));
  Air air;
  air.temperature = molecular * ratio;
  double ground = 0, above = 0;
  for (std::size_t s = 0; s < at_ground.size(); ++s) {
    ground += at_ground[s];
    above += at_86[s];
  }
  for (std::size_t s = 0; s < at_ground.size(); ++s)
    air.density[s] =
        std::lerp(at_ground[s] / ground, at_86[s] / above, changed) * pressure / (boltzmann_1976 * air.temperature);
  return air;
}

}  // namespace

double Air::total() const {
  double sum = 0;
  for (const double n : density) sum += n;
  return sum;
}

Air standard_air(double altitude) {
  PAMR_EXPECTS(altitude >= altitudes.low && altitude <= altitudes.high);
  const double z = altitude / 1000;
  if (z <= 86) return mixed_air(z);
  Densities y{};
  for (std::size_t s = 0; s < y.size(); ++s) y[s] = std::log(at_86[s] * temperature(86).t);
  double done = 86;
  for (const double next : {91.0, 95.0, 97.0, 100.0, 110.0, 115.0, 120.0, 200.0})  // where the equations change
    if (done < z) {
      y = integrate(done, std::min(next, z), y);
      done = next;
    }
  Air air;
  air.temperature = temperature(z).t;
  for (std::size_t s = 0; s < y.size(); ++s) air.density[s] = std::exp(y[s]) / air.temperature;
  return air;
}

}  // namespace pamr::dsmc
