// The powder heap ahead of the blade, from saved instants: its velocity field in the x-z plane with the
// circulation, and how well A and B are mixed in it. Measured only, in no way fed back: the spread does not
// know of it. Frame: x from the blade's face (the blade stands at x < 0), y across, z from the blade's edge.
#pragma once
#include <span>
#include <vector>

#include "dem/layer.h"

namespace gradwright {

/// Velocity of the powder ahead of the blade, averaged by volume over y and over the instants given. Cell (i,
/// k) covers x in [i, i + 1) cell, z in z_low + [k, k + 1) cell; vectors are row-major [z][x].
struct HeapField {
    double cell = 0, z_low = 0, width = 0;  ///< [m]
    int columns = 0, rows = 0;
    int instants = 0;
    double blade_low = 0,
           blade_high = 0;               ///< the blade's face at the first and last instant, scene frame [m]
    std::vector<double> mean_x, mean_z;  ///< centroid of the powder in a cell [m]; NaN as vx
    std::vector<double> vx, vz;          ///< [m/s], standing frame; NaN in cells with too few grains
    std::vector<double> solid_fraction;  ///< [-], 0 in empty cells
    std::vector<double> gi;              ///< volume share of A [-]; NaN as vx

    /// Cell centre [m].
    double x(int column) const { return (column + 0.5) * cell; }
    double z(int row) const { return z_low + (row + 0.5) * cell; }
    std::size_t at(int column, int row) const { return static_cast<std::size_t>(row) * columns + column; }
};

struct HeapFieldOptions {
    double cell = 40e-6;   ///< [m], > 0; about one D50
    double z_low = 0;      ///< lowest powder: -gap over a platform [m]
    double width = 0;      ///< modelled width, for the solid fraction [m], > 0
    int least_grains = 0;  ///< a cell with fewer, all instants together, is undefined; 0 = max(5, instants/2)
    double least_solid =
        0.05;  ///< so is one with a smaller mean solid fraction: grains in flight are no heap
};
/// Throws std::invalid_argument when cell or width is not positive. No instants or no grains: no columns.
HeapField heap_field(std::span<const Snapshot> instants, const HeapFieldOptions& options);

/// Rotation of the heap: circulation = closed integral of v . dl around the powder, anticlockwise with x to
/// the right and z up, as the sum over all loops through the powder's centroids in four neighbouring, defined
/// cells (Stokes; trapezium rule along the sides, so exact for any linear field: through the cells' centres a
/// wheel's rim, whose cells are partly filled, would count 3 % short). A uniform velocity adds nothing: the
/// standing frame and the blade's give the same. A heap that rolls ahead of the blade like a wheel towards +x
/// turns clockwise: negative.
struct HeapRotation {
    double circulation = 0;  ///< [m2/s]
    double area = 0;         ///< of those loops [m2]; 0 = too little powder for any
    double vorticity =
        0;  ///< circulation / area [1/s]: -2 x the angular velocity of a wheel that rolls towards +x
    double deviation =
        0;  ///< standard deviation of the vorticity between the single instants; NaN with one [1/s]
    /// Way of the blade during one turn of the mean rotation, 4 pi U / |vorticity| [m].
    double turn_length(double blade_speed) const;
};
HeapRotation heap_rotation(const HeapField& mean, std::span<const Snapshot> instants,
                           const HeapFieldOptions& options);

/// How well A and B are mixed in the powder that moves ahead of the blade at one instant.
struct HeapMixing {
    double time = 0, blade_x = 0;  ///< [s], [m]
    long grains = 0;
    double solid_volume = 0;  ///< [m3]
    double gi = 0;            ///< volume share of A in the heap [-]
    double lacey = 0;         ///< over cubic cells, see lacey_index [-]
    double lacey_in_slices =
        0;  ///< the same within slices of equal y, pooled: is the heap mixed along x and z? [-]
    std::vector<double> y_m, slice_gi;  ///< centre of each slice [m], share of A in it [-], NaN where empty
    std::vector<double> slice_lacey;    ///< NaN where a slice is nearly pure (nothing to mix)
};

struct HeapMixingOptions {
    double width = 0;        ///< modelled width [m], > 0
    bool periodic = false;   ///< y is wrapped into [0, width)
    double cell = 0.1e-3;    ///< edge of the cubes and thickness of the slices [m], > 0
    double least_speed = 0;  ///< slower grains (along x) are not yet, or no longer, in the heap [m/s]
};
/// Grains with x beyond the blade's face, z > 0 and speed along x of at least `least_speed`. Indices are NaN
/// without powder, or with one powder only.
HeapMixing heap_mixing(const Snapshot& instant, const HeapMixingOptions& options);

/// The grains heap_mixing counts, as indices.
std::vector<std::size_t> heap_grains(const Snapshot& instant, double least_speed);

/// Lacey's mixing index M = (S0^2 - S^2) / (S0^2 - SR^2) (P. M. C. Lacey, J. Appl. Chem. 4, 1954, 257), by
/// volume: S^2 is the variance of the cells' GI weighted by their solid, S0^2 = g (1 - g) that of unmixed
/// powder (every cell pure), SR^2 that of the same grains with labels dealt at random, p (1 - p) [sum_c
/// q_c/(V V_c) - Q/V^2] with q_c, Q = sum of squared grain volumes in a cell and in all, and p (1 - p) = g (1
/// - g) / (1 - Q/V^2). 0 = not mixed, 1 = as random as these grains can be; sampling makes values slightly
/// above 1 possible.
class LaceyIndex {
  public:
    explicit LaceyIndex(std::size_t cells) : volume_(cells, 0), volume_a_(cells, 0), square_(cells, 0) {}
    /// A grain of `volume` [m3], `share` of A in it (0 or 1), in `cell`.
    void add(std::size_t cell, double volume, double share);
    double gi() const;  ///< of all grains; NaN when empty
    double volume() const { return total_; }
    double value() const;    ///< M; NaN when S0^2 does not exceed SR^2 (one powder only, or hardly a grain)
    double excess() const;   ///< S0^2 - S^2: what mixing has removed
    double mixable() const;  ///< S0^2 - SR^2: what mixing can remove

  private:
    std::vector<double> volume_, volume_a_, square_;
    double total_ = 0, total_a_ = 0, total_square_ = 0;
};

}  // namespace gradwright
