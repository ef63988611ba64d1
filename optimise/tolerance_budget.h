// Tolerance budget: what the workshop's tolerances do to the gradation, and what each dimension would need.
//
// The wall is held by offsets (y of its points, x of its bends) and by where the plate stands, each a
// dimension with the general tolerance of ISO 2768-1 for its nominal length. On the origin map, where a new
// partition costs nothing,
//   slope_ib = (GI_b(d_i + t_i) - GI_b(d_i - t_i)) / (2 t_i)     [1/m], t_i the tolerance
//   worst case_b = sum_i |slope_ib| t_i,      RSS_b = sqrt(sum_i (slope_ib t_i)^2),
// linear in the tolerances. The 95 % band of a batch in which every dimension lies anywhere within its
// tolerance, independently and equally likely, is not: a tolerance of an eighth of a ramp bends the profile.
// It is the 95 % point of |GI_b - ideal| over 2000 plates drawn on the map; `check_band` tries it on others.
//
// Inverted: a GI error e (rms over the bins that count, root sum of squares over the dimensions) shared
// equally needs t_i = e / (sqrt(n) rms_b slope_ib). Nothing finer than the noise floor is promised: e is
// never taken below it.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "optimise/evaluation.h"

namespace gradwright {

/// General tolerances of ISO 2768-1 for linear dimensions: fine, medium, coarse, very coarse.
enum class ToleranceClass { f, m, c, v };
/// +- tolerance of a nominal length [m]. Nominals below 0.5 mm, for which the standard wants a tolerance
/// beside the dimension, take the row from 0.5 to 3 mm; rows that a class leaves empty take its nearest.
double general_tolerance(ToleranceClass tolerance_class, double nominal);
const char* to_string(ToleranceClass tolerance_class);

/// One length that a workshop holds.
struct BuildDimension {
    std::string name;      ///< "P2 y", "plate x"
    double nominal = 0;    ///< [m]
    double tolerance = 0;  ///< +- [m]
    std::function<Design(const Design&, double)>
        moved;  ///< the design with this dimension longer by so much [m]
};
/// Those of a design's partition as it stands in the dispenser: y of both ends, x and y of each bend, and the
/// plate's place in x and in y. The other dimensions stay where they are.
std::vector<BuildDimension> build_dimensions(const Study& study, const Design& design,
                                             ToleranceClass tolerance_class);

struct DimensionBudget {
    std::string name;
    double nominal = 0, tolerance = 0;  ///< [m]
    std::vector<double> slope;          ///< dGI/d(dimension) per bin [1/m]
    double slope_rms = 0;               ///< over the bins that count [1/m]
    double share = 0;                   ///< of the squared RSS error [-]
    double needed = 0;  ///< tolerance for the GI error asked for [m]; infinite when GI does not move
    bool tighter() const { return needed < tolerance; }
};

struct ToleranceBudget {
    ToleranceClass tolerance_class = ToleranceClass::m;
    std::vector<DimensionBudget> dimensions;
    std::vector<double> weight;                            ///< per bin, as everywhere
    std::vector<double> worst_case, rss, band;             ///< per bin [GI]; band: half width that holds 95 %
    double worst_case_rms = 0, rss_rms = 0, band_rms = 0;  ///< over the bins that count
    double asked = 0;                                      ///< GI error that the user asked for [GI]
    double noise_floor = 0;                                ///< of the map
    double promised = 0;                                   ///< the larger of the two: what `needed` is for
};

using Profile = std::function<std::vector<double>(const Design&)>;  ///< design -> GI per bin

/// `asked` > 0 [GI].
ToleranceBudget tolerance_budget(const Study& study, const Design& design, const Profile& profile,
                                 ToleranceClass tolerance_class, double asked, double noise_floor);

/// Share of bins inside the band over `plates` designs with every dimension drawn within its tolerance.
struct BandCheck {
    int plates = 0;
    double inside = 0;       ///< of all (plate, counting bin) pairs [-]
    double worst_error = 0;  ///< largest |GI error| met
};
BandCheck check_band(const Study& study, const Design& design, const Profile& profile,
                     const ToleranceBudget& budget, int plates, std::uint64_t seed);
/// One plate as the workshop may make it: every dimension anywhere within its tolerance.
Design drawn_plate(const std::vector<BuildDimension>& dimensions, const Design& design, std::uint64_t seed);

}  // namespace gradwright
