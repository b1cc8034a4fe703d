// What a flow reports: on a GPU some steps late.
#include <algorithm>

#include "fluid/flow/surface_flow_impl.h"

namespace rivulet {

// On a GPU all arrive some frames later, one after the other.
void SurfaceFlow::Impl::takeCounters() {
    device->readLater(counter, counter.bytes(), [to = std::weak_ptr(reports)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Reports> t = to.lock();
        if (!t) return;  // the flow was destroyed
        const auto* c = reinterpret_cast<const uint32_t*>(bytes.data());
        t->refused += c[0] + (uint64_t{c[7]} << 16U);
        t->merges += c[1];
        t->leaving = std::min(c[2], MOST_LEFT);
        t->hang = std::min(c[3], MOST_HANGING);
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
    if (thesis) return;
    device->readLater(hangs, hangs.bytes(), [to = std::weak_ptr(reports)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Reports> t = to.lock();
        if (!t) return;
        const auto* first = reinterpret_cast<const FlowHanging*>(bytes.data());
        t->hanging.clear();
        for (const FlowHanging& h : std::span(first, t->hang))
            t->hanging.push_back({.id = static_cast<uint32_t>(h.position.w),
                                  .position = vec3(h.position),
                                  .up = vec3(h.up),
                                  .pull = vec3(h.pull),
                                  .curvature = h.up.w,
                                  .share = h.pull.w,
                                  .picolitres = h.volume});
    });
}

uint64_t SurfaceFlow::refused() const { return impl_->reports->refused; }

uint32_t SurfaceFlow::room() const {
    const Impl& w = *impl_;
    const auto state = w.device->readAll<uint32_t>(w.drop, size_t{w.count()} * DROP_UINTS);
    uint32_t taken = static_cast<uint32_t>(w.births.size());
    for (uint32_t k = 0; k < w.count(); ++k) taken += state[size_t{k} * DROP_UINTS + DROP_VOLUME] != 0 ? 1 : 0;
    return taken < w.count() ? w.count() - taken : 0;
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
