#include "dem/engine.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "dem/kernel.h"

namespace gradwright {
namespace {

PairConstants pair_of(const Material& a, const Material& b, double softening) {
    // 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2, 1/G* = (2-nu1)/G1 + (2-nu2)/G2, G = E/(2(1+nu)); E = infinity
    // contributes nothing.
    auto compliance = [&](const Material& m) {
        return std::isinf(m.youngs_modulus)
                   ? 0.0
                   : (1 - m.poissons_ratio * m.poissons_ratio) / (m.youngs_modulus * softening);
    };
    auto shear_compliance = [&](const Material& m) {
        if (std::isinf(m.youngs_modulus)) return 0.0;
        const double g = m.youngs_modulus * softening / (2 * (1 + m.poissons_ratio));
        return (2 - m.poissons_ratio) / g;
    };
    const double c = compliance(a) + compliance(b), s = shear_compliance(a) + shear_compliance(b);
    return {c > 0 ? 1 / c : 0, s > 0 ? 8 / s : 0};
}

}  // namespace

Engine::Engine(const EngineOptions& options) : options_(options) {
    if (!(options.time_step > 0)) throw std::invalid_argument("Engine: time_step must be > 0");
    if (options.materials.empty()) throw std::invalid_argument("Engine: no materials");
    if ((options.period_x > 0 || options.period_z > 0) && (!(options.period_y > 0) || options.sleep))
        throw std::invalid_argument("Engine: period_x and period_z need period_y, and sleep off");
    if (options.energy_account && options.sleep)
        throw std::invalid_argument("Engine: the energy account counts every grain: sleep must be off");
    for (const auto& a : options.materials)
        for (const auto& b : options.materials) pairs_.push_back(pair_of(a, b, options.softening));
    const double e = std::clamp(options.interaction.coefficient_of_restitution, 1e-6, 1.0);
    const double beta = -std::log(e) / std::hypot(std::log(e), std::numbers::pi);
    law_.time_step = options.time_step;
    law_.static_friction = options.interaction.static_friction;
    law_.rolling_friction = options.interaction.rolling_friction;
    law_.damping_factor = 2 * std::sqrt(5.0 / 6.0) * beta;
    law_.rolling_speed = options.interaction.rolling_regularisation_speed;
    law_.friction_cap = options.interaction.friction_cap;
    adhesion_ = options.interaction.work_of_adhesion;
    if (options.adhesion_scaling == AdhesionScaling::cohesion_number)
        adhesion_ *= std::pow(options.softening, 0.4);
    threads_ = options.threads > 0 ? options.threads : omp_get_max_threads();
    if (options.precision == Precision::double_law)
        kernel_ = std::make_unique<KernelOf<double>>(*this);
    else
        kernel_ = std::make_unique<KernelOf<WideFloat>>(*this);
}

Engine::~Engine() = default;

int Engine::add_grain(const GrainSpec& g) {
    auto& s = state_;
    const int id = next_id_++;
    const std::size_t i = s.size();
    s.for_each_array([i](auto& array) { array.resize(i), array.push_back({}); });
    s.place[i] = {g.x, g.y, g.z, g.radius};
    s.material[i] = static_cast<std::uint8_t>(g.material);
    s.mass[i] = options_.materials.at(g.material).density * 4.0 / 3.0 * std::numbers::pi * g.radius *
                g.radius * g.radius;
    s.moving[i] = {g.vx, g.vy, g.vz, 1 / s.mass[i],
                   g.wx, g.wy, g.wz, 1 / (0.4 * s.mass[i] * g.radius * g.radius)};
    s.fixed[i] = g.fixed;
    s.id[i] = id;
    largest_radius_ = std::max(largest_radius_, g.radius);
    smallest_radius_ = std::min(smallest_radius_, g.radius);
    lists_valid_ = false;
    return id;
}

int Engine::add_body(const Body& body) {
    bodies_.push_back(body);
    body_removed_.push_back(0);
    lists_valid_ = false;
    return static_cast<int>(bodies_.size()) - 1;
}

void Engine::remove_body(int body) {
    body_removed_.at(body) = 1;
    kernel_->forget_body(body);
    wake_all();
    lists_valid_ = false;
}

void Engine::move_body(int body, const Body& to, bool carried) {
    if (to.kind != bodies_.at(body).kind)
        throw std::invalid_argument("Engine::move_body: a body stays of its kind");
    bodies_[body] = to;
    if (!carried) kernel_->forget_body(body);
    wake_all();
    lists_valid_ = false;
}

void Engine::set_material(std::size_t i, int material) {
    auto& s = state_;
    s.mass[i] *= options_.materials.at(material).density / options_.materials[s.material[i]].density;
    s.moving[i].inverse_mass = 1 / s.mass[i];
    s.moving[i].inverse_inertia = 1 / (0.4 * s.mass[i] * s.radius[i] * s.radius[i]);
    s.material[i] = static_cast<std::uint8_t>(material);
    lists_valid_ = false;
}

void Engine::refresh() {
    lists_valid_ = false;
}

void Engine::wake_all() {
    std::fill(state_.asleep.begin(), state_.asleep.end(), 0);
    std::fill(state_.quiet.begin(), state_.quiet.end(), 0);
    lists_valid_ = false;
}

std::size_t Engine::mobile() const {
    return static_cast<std::size_t>(std::count(state_.fixed.begin(), state_.fixed.end(), std::uint8_t{0}));
}

std::array<double, 3> Engine::velocity(std::size_t i) const {
    const auto m = kernel_->predicted(i);
    if (first_kick_ || !m.known) return {state_.vx[i], state_.vy[i], state_.vz[i]};
    return m.velocity;
}

std::array<double, 3> Engine::spin(std::size_t i) const {
    const auto m = kernel_->predicted(i);
    if (first_kick_ || !m.known) return {state_.wx[i], state_.wy[i], state_.wz[i]};
    return m.spin;
}

void Engine::scale_velocities(double factor) {
    auto& s = state_;
    for (Moving& m : s.moving)
        for (double* v : {&m.vx, &m.vy, &m.vz, &m.wx, &m.wy, &m.wz}) *v *= factor;
    kernel_->scale_motion(factor);
}

double Engine::max_speed() const {
    double top = 0;
    for (std::size_t i = 0; i < state_.size(); ++i) {
        if (state_.fixed[i] || state_.asleep[i]) continue;
        const auto v = velocity(i);
        top = std::max(top, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    return std::sqrt(top);
}

double Engine::kinetic_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < state_.size(); ++i) {
        if (state_.fixed[i]) continue;
        const auto v = velocity(i);
        const auto w = spin(i);
        sum += 0.5 * state_.mass[i] *
               (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] +
                0.4 * state_.radius[i] * state_.radius[i] * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
    }
    return sum;
}

double Engine::max_overlap_ratio() {
    return kernel_->overlaps(kOverlapRule).largest;
}
double Engine::share_overlapping(double ratio) {
    const double grains = static_cast<double>(mobile());
    return grains > 0 ? kernel_->overlaps(ratio).beyond / grains : 0;
}
std::size_t Engine::contacts() const {
    return kernel_->contacts();
}

int Engine::steps_at_once() const {
    return kernel_->steps_at_once();
}

std::size_t Engine::near_pairs() const {
    return kernel_->near_pairs();
}

double Engine::mean_coordination() {
    const double grains = static_cast<double>(mobile());
    return grains > 0 ? kernel_->coordination_sum() / grains : 0;
}

std::vector<std::size_t> Engine::overlapping_body(int body, double ratio) const {
    const Body& b = bodies_.at(body);
    if (body_removed_[body]) return {};
    std::vector<std::uint8_t> hit(state_.size(), 0);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::size_t i = 0; i < state_.size(); ++i) {
        if (state_.fixed[i]) continue;
        const auto p = nearest_point(b, b.speed_x * body_time_, b.speed_z * body_time_, state_.x[i],
                                     state_.y[i], state_.z[i]);
        hit[i] = state_.radius[i] - p.distance > ratio * state_.radius[i];
    }
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < hit.size(); ++i)
        if (hit[i]) out.push_back(i);
    return out;
}

BodyForce Engine::force_on_body(int body) const {
    return kernel_->force_on_body(body);
}
BodyForce Engine::force_on_fixed() const {
    return kernel_->force_on_fixed();
}

double Engine::memory_bytes() const {
    double bytes = kernel_->memory_bytes();
    auto count = [&](const auto& v) { bytes += static_cast<double>(v.size() * sizeof(v[0])); };
    const_cast<State&>(state_).for_each_array(count);
    count(built_);
    count(reach_);
    count(wide_reach_);
    count(inverse_reach2_);
    count(reachable_);
    count(candidate_first_);
    count(candidate_);
    count(candidate_slot_);
    count(wakeable_);
    count(new_index_);
    count(awake_);
    return bytes;
}

std::string Engine::state_hash() const {
    std::vector<std::size_t> order(state_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return state_.id[a] < state_.id[b]; });
    std::string bytes;
    bytes.reserve(state_.size() * 80);
    for (const std::size_t i : order) {
        const double values[] = {state_.x[i],  state_.y[i],  state_.z[i],  state_.vx[i], state_.vy[i],
                                 state_.vz[i], state_.wx[i], state_.wy[i], state_.wz[i]};
        bytes.append(reinterpret_cast<const char*>(&state_.id[i]), sizeof(std::int32_t));
        bytes.append(reinterpret_cast<const char*>(values), sizeof(values));
    }
    return text_hash(bytes);
}

void Engine::check_health() {
    double top = 0;
    bool finite = true;
#pragma omp parallel for schedule(static) num_threads(threads_) reduction(max : top) reduction(&& : finite)
    for (std::size_t i = 0; i < state_.size(); ++i) {
        if (state_.fixed[i]) continue;
        const Moving& m = state_.moving[i];
        const double v2 = m.vx * m.vx + m.vy * m.vy + m.vz * m.vz;
        const Place& p = state_.place[i];
        finite = finite && std::isfinite(v2 + p.x + p.y + p.z);
        top = std::max(top, v2);
    }
    if (!finite)
        failed_ = "not finite";
    else if (top > options_.speed_limit * options_.speed_limit)
        failed_ = "speed";
}

long Engine::advance(long steps) {
    long done = 0;
    // Who sleeps is decided when the near list is made: in a bed almost at rest that must not wait for the
    // list to run out.
    const long sleep_look = options_.sleep
                                ? std::max(1L, std::lround(options_.sleep_time / options_.time_step))
                                : std::numeric_limits<long>::max();
    while (done < steps && failed_.empty()) {
        if (!lists_valid_ || travel_ > 1 || steps_since_near_ >= sleep_look) {
            const double start = omp_get_wtime();
            choose_frame();
            const bool rebuild = !lists_valid_ || !choose_reach();
            check_health();
            if (!failed_.empty()) break;
            if (rebuild) {
                if (options_.energy_account) book_leaving_grains();
                rebuild_candidates();
                kernel_->carry_history();
            }
            update_sleep();
            if (rebuild || !lists_valid_) choose_reach();  // in the new order, and with who has fallen asleep
            const double middle = omp_get_wtime();
            times_.candidates += middle - start;
            kernel_->rebuild_near();
            if (rebuild || !lists_valid_) kernel_->write_records();
            lists_valid_ = true;
            travel_ = 0;
            steps_since_near_ = 0;
            if (rebuild) {
                const Overlaps now = kernel_->overlaps(kOverlapRule);
                overlaps_seen_.largest = std::max(overlaps_seen_.largest, now.largest);
                overlaps_seen_.contacts += now.contacts;
                overlaps_seen_.beyond += now.beyond;
            }
            times_.near_list += omp_get_wtime() - middle;
            ++times_.near_lists;
            times_.candidate_lists += rebuild;
        }
        done += options_.energy_account
                    ? step_with_account()
                    : kernel_->run(std::min(steps - done, sleep_look - steps_since_near_));
    }
    if (failed_.empty() && travel_ > 1) check_health();  // a run that ends here is judged here
    return done;
}

}  // namespace gradwright
