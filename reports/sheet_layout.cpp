#include "reports/sheet_layout.h"

#include <fmt/format.h>

namespace gradwright {

double preferred_scale(double limit) {
    for (double decade = 1000; decade > 1e-4; decade /= 10)
        for (double step : {5.0, 4.0, 2.5, 2.0, 1.0})
            if (step * decade <= limit * (1 + 1e-9)) return step * decade;
    return limit;
}

std::string scale_text(double scale) {
    return scale >= 1 ? fmt::format("{:g} : 1", scale) : fmt::format("1 : {:g}", 1 / scale);
}

std::vector<double> spread_apart(std::vector<double> wanted, double step) {
    const std::size_t n = wanted.size();
    for (int sweep = 0; sweep < 200; ++sweep) {
        bool moved = false;
        for (std::size_t i = 1; i < n; ++i) {
            const double overlap = step - (wanted[i] - wanted[i - 1]);
            if (overlap > 1e-6) {
                wanted[i] += overlap / 2;
                wanted[i - 1] -= overlap / 2;
                moved = true;
            }
        }
        if (!moved) break;
    }
    return wanted;
}

}  // namespace gradwright
