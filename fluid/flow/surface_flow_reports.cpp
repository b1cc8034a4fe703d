// What a flow reports: on a GPU some steps late.
#include <algorithm>

#include "fluid/flow/surface_flow_impl.h"

namespace rivulet {

// On a GPU all arrive some frames later, one after the other.
void SurfaceFlow::Impl::takeCounters(size_t freeAt) {
    device->readLater(counter, counter.bytes(), [to = std::weak_ptr(reports)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Reports> t = to.lock();
        if (!t) return;  // the flow was destroyed
        const auto* c = reinterpret_cast<const uint32_t*>(bytes.data());
        t->refused += c[0] + (uint64_t{c[7]} << 16U);
        t->merges += c[1];
        t->leaving = std::min(c[2], MOST_LEFT);
        t->film = c[6] > 0;
        t->evaporated += c[4];
    });
    device->readLater(left, left.bytes(), [to = std::weak_ptr(reports)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Reports> t = to.lock();
        if (!t) return;
        const auto* first = reinterpret_cast<const FlowLeft*>(bytes.data());
        std::vector<FlowLeft> some(first, first + t->leaving);
        std::sort(some.begin(), some.end(), [](const FlowLeft& a, const FlowLeft& b) { return a.position.w < b.position.w; });
        for (const FlowLeft& l : some) {
            LeftDrop& gone = t->gone.emplace_back(LeftDrop{vec3(l.position), vec3(l.velocity), l.volume, l.triangle, {}});
            // As it hung in the step before.
            const auto hung = std::find_if(t->hanging.begin(), t->hanging.end(),
                                           [&](const HangingDrop& h) { return l.position.w == static_cast<float>(h.id); });
            if (l.letGo > 0 && hung != t->hanging.end()) gone.hung = *hung;
            t->left += l.volume;
        }
    });
    device->readLater(
        grid->cellStart(), sizeof(uint32_t),
        [to = std::weak_ptr(reports), step = steps](std::span<const std::byte> bytes) {
            const std::shared_ptr<Reports> t = to.lock();
            if (!t) return;
            t->inUse = *reinterpret_cast<const uint32_t*>(bytes.data());
            t->sortedIn = step;
        },
        freeAt * sizeof(uint32_t));
    if (thesis) return;
    device->readLater(hangs, hangs.bytes(), [to = std::weak_ptr(reports)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Reports> t = to.lock();
        if (!t) return;
        const auto* first = reinterpret_cast<const FlowHanging*>(bytes.data());
        t->hanging.clear();
        for (const FlowHanging& h : std::span(first, std::min(first->count, MOST_HANGING)))
            t->hanging.push_back({.id = static_cast<uint32_t>(h.position.w),
                                  .position = vec3(h.position),
                                  .up = vec3(h.up),
                                  .pull = vec3(h.pull),
                                  .curvature = h.up.w,
                                  .share = h.pull.w,
                                  .picolitres = h.volume});
    });
}

// Where the skin is, for shape(): the host has its own positions; what a GPU computes arrives some steps later.
void SurfaceFlow::Impl::takePlaces(const SurfaceFlowInputs& inputs) {
    if (inputs.moved == nullptr && inputs.positions.empty()) return;
    deforms = true;
    movedAt = time;
    if (device->backend() == Backend::cpu) return;  // shape() reads it
    if (inputs.moved != nullptr) {
        if (!asked) {  // shape() was not called yet: its first call reads the places
            reports->places.clear();
            return;
        }
        device->readLater(point, mesh.rest.size() * sizeof(vec4),
                          [to = std::weak_ptr(reports), at = time, of = moves](std::span<const std::byte> bytes) {
                              const std::shared_ptr<Reports> t = to.lock();
                              if (!t) return;
                              const auto* first = reinterpret_cast<const vec4*>(bytes.data());
                              t->placesBefore.swap(t->places);
                              t->beforeAt = t->placesAt;
                              t->places.assign(first, first + bytes.size() / sizeof(vec4));
                              t->placesAt = at;
                              t->placesOf = of;
                          });
        return;
    }
    reports->places.clear();
    reports->places.reserve(mesh.given.size());
    for (const uint32_t k : mesh.given) reports->places.emplace_back(inputs.positions[k], 0.0F);
    reports->placesBefore.clear();
    reports->placesAt = time;
    reports->placesOf = moves;
}

uint64_t SurfaceFlow::refused() const { return impl_->reports->refused; }

uint32_t SurfaceFlow::room() const {
    const Impl& w = *impl_;
    // Of each step that is not reported yet: births, one drop of each brim at most, and one pearl of each drop. Pearls leave a quarter
    // free.
    const uint64_t pearlsEnd = w.params.pearls && !w.thesis ? w.count() - w.count() / 4 : 0;
    uint64_t used = w.reports->inUse;
    const size_t late = std::min<size_t>(w.steps - w.reports->sortedIn, w.bornSince.size());
    for (size_t k = w.bornSince.size() - late; k < w.bornSince.size(); ++k) {
        const uint64_t before = used;
        used += w.bornSince[k] + w.brims;
        if (used < pearlsEnd) used = std::min(used + before, pearlsEnd);
    }
    used += w.births.size();
    return used < w.count() ? w.count() - static_cast<uint32_t>(used) : 0;
}

SurfaceFlow::Shape SurfaceFlow::shape() const {
    constexpr double kMostLate = 0.1;  // s
    Impl& w = *impl_;
    w.asked = true;
    const Impl::Reports& known = *w.reports;
    if (!known.places.empty() && w.movedAt - known.placesAt > kMostLate) {
        w.device->finish();
        w.device->poll();
    }
    const bool direct = w.device->backend() == Backend::cpu || (w.deforms && known.places.empty());
    const uint64_t from = direct ? w.moves : known.placesOf;
    if (w.shownAs == w.moves && w.shownFrom == from) return {w.moves, from, w.shown};
    w.shownAs = w.moves;
    w.shownFrom = from;
    if (direct) {
        w.shown = w.device->readAll<vec4>(w.point, w.mesh.rest.size());
    } else if (known.places.empty()) {
        w.shown.clear();
        w.shown.reserve(w.mesh.rest.size());
        for (const vec3& p : w.mesh.rest) w.shown.emplace_back(p, 0.0F);
    } else {
        w.shown = known.places;
        const double late = w.movedAt - known.placesAt, apart = known.placesAt - known.beforeAt;
        if (late > 0 && apart > 0 && known.placesBefore.size() == w.shown.size())
            for (size_t k = 0; k < w.shown.size(); ++k) {
                const vec3 way = vec3(known.places[k]) - vec3(known.placesBefore[k]);
                if (glm::dot(way, way) > kJump * kJump * static_cast<float>(apart * apart)) continue;  // moved by the user
                w.shown[k] += vec4(way * static_cast<float>(late / apart), 0.0F);
            }
    }
    return {w.moves, from, w.shown};
}

std::vector<LeftDrop> SurfaceFlow::takeLeft() {
    std::vector<LeftDrop> taken;
    taken.swap(impl_->reports->gone);
    return taken;
}

uint64_t SurfaceFlow::leaving() const {
    uint64_t sum = 0;
    for (const LeftDrop& d : impl_->reports->gone) sum += d.picolitres;
    return sum;
}

const std::vector<HangingDrop>& SurfaceFlow::hanging() const { return impl_->reports->hanging; }

// Reads arrive in the order of their requests: the counters of the last step arrive before its drops and films.
void SurfaceFlow::ledgerLater(std::function<void(const Ledger&)> then) const {
    Impl& w = *impl_;
    const auto l = std::make_shared<Ledger>();
    l->added = w.added;
    l->handed = w.reports->left - leaving();
    for (const FlowBirth& b : w.births) l->drops += b.volume;  // with the next step
    const auto words = [](std::span<const std::byte> bytes) {
        return std::span(reinterpret_cast<const uint32_t*>(bytes.data()), bytes.size() / sizeof(uint32_t));
    };
    w.device->readLater(w.drop, size_t{w.count()} * DROP_UINTS * sizeof(uint32_t), [l, words](std::span<const std::byte> bytes) {
        const std::span<const uint32_t> state = words(bytes);
        for (size_t k = 0; k < state.size(); k += DROP_UINTS) l->drops += state[k + DROP_VOLUME];
    });
    w.device->readLater(w.film, size_t{w.firstCell.back()} * sizeof(uint32_t),
                        [l, words, from = std::weak_ptr(w.reports), then = std::move(then)](std::span<const std::byte> bytes) {
                            const std::shared_ptr<const Impl::Reports> reports = from.lock();
                            if (!reports) return;  // the flow was destroyed
                            for (const uint32_t v : words(bytes)) l->film += v;
                            l->left = reports->left;
                            l->evaporated = reports->evaporated;
                            l->refused = reports->refused;
                            l->merges = reports->merges;
                            then(*l);
                        });
}

void SurfaceFlow::brimsLater(std::function<void(std::span<const uint64_t>)> then) const {
    const Impl& w = *impl_;
    constexpr size_t kDrop = DROP_UINTS * sizeof(uint32_t);
    w.device->readLater(
        w.drop, w.brimPlaces * kDrop,
        [places = w.placesOf, then = std::move(then)](std::span<const std::byte> bytes) {
            const auto* state = reinterpret_cast<const uint32_t*>(bytes.data());
            std::vector<uint64_t> content;
            size_t at = 0;
            for (const uint32_t count : places) {
                uint64_t& sum = content.emplace_back();
                for (uint32_t k = 0; k < count; ++k, ++at) sum += state[at * DROP_UINTS + DROP_VOLUME];
            }
            then(content);
        },
        (w.count() - w.brimPlaces) * kDrop);
}

}  // namespace rivulet
