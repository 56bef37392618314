// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr double join_tolerance = 1e-9;
constexpr double pi = std::numbers::pi;

bool is_finite(Meridian m) { return std::isfinite(m.x) && std::isfinite(m.r); }

std::string text(Meridian m) { return "[" + decimal(m.x) + ", " + decimal(m.r) + "]"; }

/// Diagonal of the box around the ends of the pieces and the axis below them.
double size_of(const std::vector<ProfilePiece>& pieces) {
  double least = std::numeric_limits<double>::infinity(), greatest = -least, highest = 0;
  for (const ProfilePiece& piece : pieces) {
    for (const Meridian end : {piece.from, piece.to}) {
      if (!is_finite(end)) throw Error("expected finite numbers, found the point " + text(end));
      least = std::min(least, end.x);
      greatest = std::max(greatest, end.x);
      highest = std::max(highest, std::abs(end.r));
    }
    if (piece.arc && !is_finite(piece.arc->center))
      throw Error("expected finite numbers, found the center " + text(piece.arc->center));
  }
  return norm(Meridian{greatest - least, highest});
}

/// Moves a point onto `target` when it is there but for rounding; false when it is not there.
bool snap(Meridian& point, Meridian target, double tolerance) {
  if (norm(point - target) > tolerance) return false;
  point = target;
  return true;
}

void snap_to_axis(Meridian& point, double tolerance) {
  if (std::abs(point.r) <= 1e-3 * tolerance) point.r = 0;
  if (point.r < 0) throw Error("expected r >= 0, found the point " + text(point));
}

/// Runs `check` with "profile piece N: " put before its error.
template <class Check>
void for_piece(std::size_t index, Check check) {
  try {
    check();
  } catch (const Error& error) {
    throw Error(fmt::format("profile piece {}: {}", index + 1, error.what()));
  }
}

}  // namespace

Profile::Profile(const std::vector<ProfilePiece>& pieces) {
  if (pieces.empty()) throw Error("profile: expected at least one piece, found none");
  std::vector<ProfilePiece> chain = pieces;
  double size = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) for_piece(i, [&] { size_of({chain[i]}); });
  size = size_of(chain);
  const double tolerance = join_tolerance * size;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    for_piece(i, [&] {
      if (i > 0 && !snap(chain[i].from, chain[i - 1].to, tolerance))
        throw Error("expected to start at the end of the piece before, " + text(chain[i - 1].to) + ", found " +
                    text(chain[i].from));
      snap_to_axis(chain[i].from, tolerance);
      snap_to_axis(chain[i].to, tolerance);
      if (i > 0 && i + 1 == chain.size()) snap(chain[i].to, chain[0].from, tolerance);
      if (norm(chain[i].to - chain[i].from) <= tolerance)
        throw Error("expected two distinct ends, found " + text(chain[i].from) + " twice");
      pieces_.push_back(make_piece(chain[i]));
    });
  }
  find_corners();
}

void Profile::find_corners() {
  constexpr double min_sine = 0.0871557427476582;  // of 5 degrees
  const auto leaves = [](const Piece& piece, bool at_start) -> Meridian {
    if (!piece.is_arc) return piece.tangent;
    const Meridian out = at_start ? piece.from_center : piece.to_center;
    return {-piece.sense * out.r, piece.sense * out.x};
  };
  const auto is_corner = [&](const Piece& before, const Piece& after) {
    if (!(before.to == after.from) || !(before.to.r > 0)) return false;
    const Meridian t = leaves(before, false), u = leaves(after, true);
    return std::abs(cross(t, u)) > min_sine || dot(t, u) < 0;
  };
  run_.push_back(0);
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    const bool sharp = is_corner(pieces_[i - 1], pieces_[i]);
    run_.push_back(run_.back() + (sharp ? 1 : 0));
    if (sharp) corners_.push_back({pieces_[i].from, {run_.back() - 1, run_.back()}});
  }
  if (is_corner(pieces_.back(), pieces_.front()))  // of a closed profile
    corners_.push_back({pieces_.front().from, {run_.back(), 0}});
}

int Profile::run_at(Meridian at) const { return run_[nearest_piece(at)]; }

const Profile::Corner& Profile::nearest_corner(Meridian at) const {
  return *std::min_element(corners_.begin(), corners_.end(),
                           [&](const Corner& a, const Corner& b) { return norm(at - a.point) < norm(at - b.point); });
}

Profile::Piece Profile::make_piece(const ProfilePiece& given) {
  Piece piece;
  piece.from = given.from;
  piece.to = given.to;
  if (given.arc) {
    make_arc(*given.arc, piece);
    return piece;
  }
  const Meridian along = given.to - given.from;
  piece.length = norm(along);
  piece.tangent = {along.x / piece.length, along.r / piece.length};
  return piece;
}

void Profile::make_arc(const ProfileArc& given, Piece& piece) {
  const double start = norm(piece.from - given.center), end = norm(piece.to - given.center);
  if (!(std::abs(start - end) <= join_tolerance * std::max(start, end)))
    throw Error("expected the same distance from both ends to the center " + text(given.center) + ", found " +
                decimal(start) + " and " + decimal(end));
  piece.is_arc = true;
  const Meridian chord = piece.to - piece.from;
  const Meridian offset = given.center - (piece.from + 0.5 * chord);
  piece.center = given.center - (dot(offset, chord) / dot(chord, chord)) * chord;
  const Meridian from = piece.from - piece.center, to = piece.to - piece.center;
  piece.length = 0.5 * (norm(from) + norm(to));
  piece.from_center = (1.0 / norm(from)) * from;
  piece.to_center = (1.0 / norm(to)) * to;
  const double sine = cross(piece.from_center, piece.to_center), cosine = dot(piece.from_center, piece.to_center);
  if (!given.clockwise && cosine < 0 && std::abs(sine) < 1e-6)
    throw Error("expected the key clockwise for a half circle (both arcs are equally long), found none");
  const bool clockwise = given.clockwise.value_or(sine < 0);
  piece.sense = clockwise ? -1 : 1;
  const double angle = std::atan2(piece.sense * sine, cosine);
  piece.sweep = angle > 0 ? angle : angle + 2 * pi;
  if (spans(piece, {0, -1}) && piece.center.r - piece.length < -join_tolerance * piece.length)
    throw Error("expected r >= 0, found an arc that reaches down to r = " + decimal(piece.center.r - piece.length));
}

/// True when the direction from the center meets the arc; tests by side only, so that no angle is computed.
bool Profile::spans(const Piece& arc, Meridian from_center) {
  if (arc.sweep <= pi)
    return arc.sense * cross(arc.from_center, from_center) >= 0 && arc.sense * cross(from_center, arc.to_center) >= 0;
  return !(arc.sense * cross(arc.to_center, from_center) > 0 && arc.sense * cross(from_center, arc.from_center) > 0);
}

Profile::Nearest Profile::nearest_on(const Piece& piece, Meridian at) {
  if (!piece.is_arc) {
    const double along = dot(at - piece.from, piece.tangent);
    const Meridian point =
        along <= 0 ? piece.from : (along >= piece.length ? piece.to : piece.from + along * piece.tangent);
    return {point, {-piece.tangent.r, piece.tangent.x}, norm(at - point)};
  }
  const Meridian out = at - piece.center;
  const double distance = norm(out);
  if (!(distance > min_length)) return {piece.from, -piece.sense * piece.from_center, piece.length};
  if (spans(piece, out)) {
    const Meridian unit{out.x / distance, out.r / distance};
    return {piece.center + piece.length * unit, -piece.sense * unit, std::abs(distance - piece.length)};
  }
  const double to_start = norm(at - piece.from), to_end = norm(at - piece.to);
  if (to_start <= to_end) return {piece.from, -piece.sense * piece.from_center, to_start};
  return {piece.to, -piece.sense * piece.to_center, to_end};
}

Profile::Nearest Profile::nearest(Meridian at) const {
  Nearest best = nearest_on(pieces_.front(), at);
  for (std::size_t i = 1; i < pieces_.size(); ++i) {
    const Nearest other = nearest_on(pieces_[i], at);
    if (other.distance < best.distance) best = other;
  }
  return best;
}

std::size_t Profile::nearest_piece(Meridian at) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < pieces_.size(); ++i)
    if (nearest_on(pieces_[i], at).distance < nearest_on(pieces_[best], at).distance) best = i;
  return best;
}

std::optional<Meridian> Profile::nearest_joint(Meridian at) const {
  std::optional<Meridian> best;
  for (std::size_t i = 0; i + 1 < pieces_.size(); ++i) {
    const Meridian joint = pieces_[i].to;
    if (joint.r > 0 && (!best || norm(at - joint) < norm(at - *best))) best = joint;
  }
  return best;
}

double Profile::area() const {
  double sum = 0;
  for (const Piece& p : pieces_) {
    if (p.is_arc)
      sum += 2 * pi * p.length * (p.center.r * p.sweep + p.length * p.sense * (p.from_center.x - p.to_center.x));
    else
      sum += pi * (p.from.r + p.to.r) * p.length;
  }
  return sum;
}

double Profile::volume() const {
  double sum = 0;
  for (const Piece& p : pieces_) {
    if (!p.is_arc) {
      const double a = p.from.r, b = p.to.r;
      sum += pi / 3 * (p.to.x - p.from.x) * (a * a + a * b + b * b);
      continue;
    }
    // With r = c + R sin t and dx = -R sin t dt: integrals of sin t, sin^2 t and sin^3 t from one end to the other.
    const double c0 = p.from_center.x, s0 = p.from_center.r, c1 = p.to_center.x, s1 = p.to_center.r;
    const double first = c0 - c1;
    const double second = 0.5 * (p.sense * p.sweep - (s1 * c1 - s0 * c0));
    const double third = first - (c0 * c0 * c0 - c1 * c1 * c1) / 3;
    const double c = p.center.r, radius = p.length;
    sum -= pi * radius * (c * c * first + 2 * c * radius * second + radius * radius * third);
  }
  return sum;
}

double Profile::magnitude() const {
  double bound = 0;
  for (const Piece& p : pieces_) {
    for (const double value : {p.from.x, p.from.r, p.to.x, p.to.r}) bound = std::max(bound, std::abs(value));
    if (p.is_arc) bound = std::max({bound, std::abs(p.center.x) + p.length, std::abs(p.center.r) + p.length});
  }
  return bound;
}

bool Profile::is_disc() const {
  const Piece& p = pieces_.front();
  return pieces_.size() == 1 && !p.is_arc && p.from.x == p.to.x && (p.from.r == 0 || p.to.r == 0);
}

}  // namespace pamr::geometry
