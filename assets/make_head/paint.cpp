#include "assets/make_head/paint.h"

#include <stb_image_write.h>

#include <algorithm>
#include <cmath>

#include "assets/make_head/hair.h"
#include "assets/make_head/noise.h"

namespace rivulet::head {
namespace {

struct Texel {
    dvec3 at{0}, normal{0};
    std::array<double, kWeights> weight{};
    double hollow = 0;  // curvature: > 0 in creases
    bool covered = false;
};

// Mean curvature in 1/cm, smoothed over a few rings: where skin folds it is darker and redder.
std::vector<double> hollows(const Surface& head, const std::vector<dvec3>& normals) {
    Neighbours around = neighboursOf(head);
    std::vector<double> hollow(head.vertices.size(), 0), next;
    for (uint32_t v = 0; v < hollow.size(); ++v) {
        double sum = 0;
        for (uint32_t n : around[v]) {
            dvec3 d = head.vertices[n].at - head.vertices[v].at;
            sum += 2 * glm::dot(d, normals[v]) / std::max(glm::dot(d, d), 1e-6);
        }
        hollow[v] = glm::clamp(sum / static_cast<double>(around[v].size()), -4.0, 4.0);
    }
    for (int step = 0; step < 3; ++step) {
        next = hollow;
        for (uint32_t v = 0; v < hollow.size(); ++v) {
            double sum = 0;
            for (uint32_t n : around[v]) sum += hollow[n];
            next[v] = 0.5 * hollow[v] + 0.5 * sum / static_cast<double>(around[v].size());
        }
        hollow.swap(next);
    }
    return hollow;
}

std::vector<Texel> rasterised(const Surface& head, const std::vector<dvec3>& normals, size_t& overlaps) {
    std::vector<double> hollow = hollows(head, normals);
    std::vector<Texel> texels(size_t{kTextureSize} * kTextureSize);
    overlaps = 0;
    for (const Triangle& t : head.triangles) {
        dvec2 q[3];
        for (int k = 0; k < 3; ++k) q[k] = dvec2(head.vertices[t[k]].uv.x, 1 - head.vertices[t[k]].uv.y) * double{kTextureSize} - 0.5;
        dvec2 low = glm::floor(glm::min(q[0], glm::min(q[1], q[2]))), high = glm::ceil(glm::max(q[0], glm::max(q[1], q[2])));
        double area = (q[1].x - q[0].x) * (q[2].y - q[0].y) - (q[1].y - q[0].y) * (q[2].x - q[0].x);
        if (area == 0) continue;
        for (int y = std::max(0, static_cast<int>(low.y)); y <= std::min(kTextureSize - 1, static_cast<int>(high.y)); ++y)
            for (int x = std::max(0, static_cast<int>(low.x)); x <= std::min(kTextureSize - 1, static_cast<int>(high.x)); ++x) {
                dvec2 p(x, y);
                double b[3];
                for (int k = 0; k < 3; ++k) {
                    dvec2 u = q[(k + 1) % 3] - p, w = q[(k + 2) % 3] - p;
                    b[k] = (u.x * w.y - u.y * w.x) / area;
                }
                if (std::min({b[0], b[1], b[2]}) < 0) continue;
                Texel& texel = texels[static_cast<size_t>(y) * kTextureSize + x];
                if (texel.covered && std::min({b[0], b[1], b[2]}) > 1e-6) ++overlaps;
                texel = {};
                texel.covered = true;
                for (int k = 0; k < 3; ++k) {
                    const Vertex& v = head.vertices[t[k]];
                    texel.at += v.at * b[k];
                    texel.normal += normals[t[k]] * b[k];
                    texel.hollow += hollow[t[k]] * b[k];
                    for (int w = 0; w < kWeights; ++w) texel.weight[w] += v.weight[w] * b[k];
                }
            }
    }
    return texels;
}

// A brow as hairs, drawn once in its own plane: along it and across it, in cm.
class Brow {
  public:
    Brow() : ink_(size_t{kWide} * kHigh, 0) {
        for (int h = 0; h < 900; ++h) {
            double t = (h + hash(h, 0, 0, 71)) / 900, across = 2 * hash(h, 1, 0, 71) - 1;
            double half = browHalfWidth(t);
            dvec2 at(t * kLength, across * half * 0.95);
            // Upright near the nose, then outward; upper hairs bend down, lower ones up.
            double angle =
                glm::mix(1.35, 0.25, smoothstep(0.0, 0.35, t)) - 0.55 * across * smoothstep(0.15, 0.6, t) - 0.25 * smoothstep(0.6, 1.0, t);
            angle += 0.35 * (hash(h, 2, 0, 71) - 0.5);
            double length = glm::mix(0.55, 0.75, hash(h, 3, 0, 71)) * (0.6 + 0.4 * std::sin(kPi * std::min(t + 0.2, 1.0)));
            double weight = (0.55 + 0.4 * hash(h, 4, 0, 71)) * smoothstep(-0.04, 0.32, t);
            for (int s = 0; s <= 40; ++s) {
                double u = s / 40.0;
                dvec2 p = at + length * (u - 0.35) * dvec2(std::cos(angle - 0.5 * u), std::sin(angle - 0.5 * u));
                stamp(p, weight * (1 - 0.75 * u), glm::mix(0.010, 0.005, u));
            }
        }
    }
    // `p` in a frame where x is outward from the middle of the face.
    double at(dvec3 p) const {
        if (p.y < 3.2 || p.y > 6.4 || p.x < 0.4 || p.z < 1.5) return 0;
        double best = 1e9, run = 0;
        dvec2 place(0);
        for (size_t i = 0; i + 1 < kBrowLine.size(); ++i) {
            dvec3 a = kBrowLine[i], ab = kBrowLine[i + 1] - a;
            double length = glm::length(ab), t = glm::dot(p - a, ab) / (length * length);
            double on = glm::clamp(t, i == 0 ? -0.5 : 0.0, i + 2 == kBrowLine.size() ? 1.5 : 1.0);
            dvec3 off = p - (a + ab * on);
            if (double d = glm::length(off); d < best) {
                best = d;
                place = {run + on * length, off.y >= 0 ? d : -d};
            }
            run += length;
        }
        place.x *= kLength / run;
        double x = (place.x + 0.6) / kCell, y = (place.y + 0.9) / kCell;
        auto i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
        if (i < 0 || j < 0 || i + 1 >= kWide || j + 1 >= kHigh) return 0;
        double fx = x - i, fy = y - j;
        auto ink = [&](int a, int b) { return double{ink_[static_cast<size_t>(b) * kWide + a]}; };
        return std::min(1.0, glm::mix(glm::mix(ink(i, j), ink(i + 1, j), fx), glm::mix(ink(i, j + 1), ink(i + 1, j + 1), fx), fy));
    }

  private:
    static constexpr double kLength = 4.6, kCell = 0.012;
    static constexpr int kWide = 500, kHigh = 150;
    void stamp(dvec2 p, double weight, double radius) {
        double x = (p.x + 0.6) / kCell, y = (p.y + 0.9) / kCell, r = radius / kCell + 0.5;
        for (int j = static_cast<int>(y - r); j <= y + r + 1; ++j)
            for (int i = static_cast<int>(x - r); i <= x + r + 1; ++i) {
                if (i < 0 || j < 0 || i >= kWide || j >= kHigh) continue;
                double cover = glm::clamp(r - std::hypot(i - x, j - y), 0.0, 1.0) * weight;
                float& ink = ink_[static_cast<size_t>(j) * kWide + i];
                ink = std::max(ink, static_cast<float>(cover));
            }
    }
    std::vector<float> ink_;
};

void put(Picture& picture, size_t texel, int channel, double value) {
    picture.bytes[texel * picture.channels + channel] = static_cast<uint8_t>(std::lround(glm::clamp(value, 0.0, 1.0) * 255));
}

Picture blank(int size, int channels) {
    return {size, size, channels, std::vector<uint8_t>(static_cast<size_t>(size) * size * channels, 0)};
}

// Colour beyond the chart's edges, so that filtering brings no dark seams.
void spreadOut(Picture& picture, std::vector<char> known, int texels) {
    int n = picture.width;
    for (int step = 0; step < texels; ++step) {
        std::vector<char> next = known;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                size_t at = static_cast<size_t>(y) * n + x;
                if (known[at]) continue;
                int count = 0;
                std::array<int, 4> sum{};
                for (int k = 0; k < 9; ++k) {
                    int i = x + k % 3 - 1, j = y + k / 3 - 1;
                    if (i < 0 || j < 0 || i >= n || j >= n || !known[static_cast<size_t>(j) * n + i]) continue;
                    ++count;
                    for (int c = 0; c < picture.channels; ++c)
                        sum[c] += picture.bytes[(static_cast<size_t>(j) * n + i) * picture.channels + c];
                }
                if (count == 0) continue;
                for (int c = 0; c < picture.channels; ++c) picture.bytes[at * picture.channels + c] = static_cast<uint8_t>(sum[c] / count);
                next[at] = 1;
            }
        known.swap(next);
    }
}

dvec3 rgb(int r, int g, int b) { return dvec3(r, g, b) / 255.0; }

const dvec3 kWhiteByCorner = rgb(206, 150, 138);  // of an eye, towards the nose

// The sheet of an inner corner: what is not caruncle or plica is the conjunctiva, which pales into the white.
dvec3 fleshColour(dvec2 place) {
    const double t = kFleshEnd * place.x, v = glm::mix(-kFleshTuck, 1 + kFleshTuck, place.y);
    const CornerFlesh flesh = cornerFlesh(t, v);
    const double grain = fractal(dvec3(t * 150, v * 12, 0.3), 3, 411), vein = 1 - std::abs(fractal(dvec3(t * 55, v * 5, 0.7), 3, 412)) * 7;
    dvec3 colour = glm::mix(rgb(184, 96, 88), rgb(190, 150, 138), smoothstep(0.085, 0.15, flesh.along));
    colour = glm::mix(colour, rgb(214, 128, 116), flesh.caruncle);
    colour = glm::mix(colour, rgb(234, 172, 152), 0.8 * flesh.lump);
    colour = glm::mix(colour, rgb(208, 136, 126), 0.75 * flesh.plica);
    colour = glm::mix(colour, rgb(176, 72, 66), 0.35 * std::max(0.0, vein) * (1 - flesh.caruncle) * smoothstep(0.17, 0.12, t));
    return colour * (1 + 0.05 * grain);
}

}  // namespace

SkinPictures paintSkin(const Surface& head, const std::array<Eye, 2>& eyes) {
    SkinPictures skin;
    std::vector<dvec3> normals = normalsOf(positionsOf(head), head.triangles);
    std::vector<Texel> texels = rasterised(head, normals, skin.overlaps);
    skin.albedo = blank(kTextureSize, 3);
    skin.relief = blank(kTextureSize, 1);
    skin.regions = blank(kTextureSize, 4);
    skin.flush = blank(kTextureSize, 3);
    const Brow brow;
    std::vector<char> covered(texels.size());
    std::vector<double> cheekSides;
    for (size_t i = 0; i < texels.size(); ++i) {
        const Texel& t = texels[i];
        covered[i] = t.covered;
        if (!t.covered) {
            put(skin.relief, i, 0, 128 / 255.0);
            for (int c = 0; c < 3; ++c) put(skin.albedo, i, c, rgb(196, 150, 128)[c]);
            continue;
        }
        dvec3 p = t.at, m(std::abs(p.x), p.y, p.z);  // m: mirrored onto the left, for what is placed by feature
        double face = 1 - t.weight[kLoft];
        if (i + kTextureSize + 1 < texels.size() && m.x > 3 && m.x < 5.2 && p.y > -2.5 && p.y < 1 && p.z > 1 && texels[i + 1].covered &&
            texels[i + kTextureSize].covered)
            cheekSides.push_back(10 * std::max(glm::distance(texels[i + 1].at, p), glm::distance(texels[i + kTextureSize].at, p)));

        // Where things are.
        double cheek = bell(m, {4.3, -0.6, 3.6}, {1.7, 1.5, 2.5}), nose = bell(m, {0, -0.7, 7.2}, {1.25, 1.1, 1.2});
        double wing = bell(m, {1.35, -1.0, 5.9}, {0.5, 0.7, 0.8}), chin = bell(m, {0, -7.4, 5.0}, {1.5, 1.1, 2.0});
        double nostril = bell(m, {0.80, -1.28, 6.30}, {0.25, 0.30, 0.42}) * smoothstep(0.1, -0.45, t.normal.y);
        nostril = std::max(nostril, t.weight[kNostril]);
        double forehead = smoothstep(4.8, 6.2, p.y) * face * smoothstep(5.5, 3.5, m.x);
        double lip = smoothstep(0.38, 0.75, t.weight[kLip] + 0.05 * fractal(p * 6.0, 2, 5)),
               mouth = smoothstep(0.15, 0.8, t.weight[kMouth]);
        double ear = t.weight[kEar];
        const Eye& eye = eyes[p.x >= 0 ? 0 : 1];
        EyePoint e = eye.seen(p);
        double byEye = p.z > eye.centre.z ? std::exp(-std::pow(glm::distance(p, eye.centre) / 2.25, 6.0)) : 0;
        double toUpper = (e.up - eye.margin(true, e.out)) * 1.4, toLower = (eye.margin(false, e.out) - e.up) * 1.4;
        double rim = t.weight[kRim];
        double lid = byEye * smoothstep(0.75, 0.1, toUpper) * smoothstep(-0.1, 0.05, toUpper);
        double under = byEye * smoothstep(0.0, 0.15, toLower) * smoothstep(1.0, 0.35, toLower);
        double corner = bell(m, {1.75, 2.5, 3.75}, {0.42, 0.38, 0.6});
        double hollow = glm::clamp(t.hollow, -1.0, 2.5);

        // Colour.
        dvec3 colour = rgb(214, 166, 140);
        colour += dvec3(0.030, 0.024, 0.018) * fractal(p * 0.35, 3, 11);
        double blotch = fractal(p * 1.6, 4, 12), speck = fractal(p * 7.0, 3, 13), grain = fractal(p * 24.0, 2, 14);
        double red =
            0.62 * cheek + 0.62 * nose + 0.55 * wing + 0.25 * chin + 0.62 * ear + 0.14 * lid + 0.12 * corner + 0.38 * blotch + 0.18 * speck;
        red += 0.35 * glm::clamp(hollow, 0.0, 1.5) * face * (1 - 0.7 * byEye);
        colour += glm::clamp(red, -0.4, 1.6) * dvec3(0.008, -0.072, -0.062);
        colour += forehead * dvec3(0.012, 0.016, 0.006);
        colour -= under * dvec3(0.050, 0.050, 0.024);
        colour -= byEye * smoothstep(0.1, 0.9, toUpper) * smoothstep(1.6, 0.7, toUpper) * dvec3(0.012, 0.016, 0.014);
        colour -= corner * dvec3(0.02, 0.02, 0.01);
        colour *= 1 - 0.10 * glm::clamp(hollow, -0.6, 2.0) * (1 - 0.5 * lip) * (1 - 0.7 * byEye);
        colour *= 1 + 0.022 * grain + 0.018 * speck;
        double which = 0, freckle = cells(p * 2.6, 31, which);
        double freckled = (cheek + 0.8 * nose + 0.18) * smoothstep(0.19, 0.05, freckle + 0.03 * grain) * smoothstep(0.45, 0.75, which);
        colour = glm::mix(colour, colour * dvec3(0.86, 0.76, 0.68), 0.55 * glm::clamp(freckled, 0.0, 1.0));

        // Short hair: denser up the scalp, with a scattered edge.
        double crop = cropAt(p, ear);
        double stubble = 0.5 + 0.5 * cells(p * 13.0, 93, which);
        colour = glm::mix(colour, rgb(74, 54, 42),
                          std::pow(std::max(crop, 0.0), 1.5) * glm::clamp(0.62 + 0.28 * stubble + 0.1 * grain, 0.0, 0.92));

        // Lips: lines across them, darker towards where they meet.
        double fan = p.x * (1 + 0.22 * (p.y + 4.2)), broken = fractal(dvec3(p.x * 4, p.y * 4, p.z), 3, 41);
        double line = std::sin(fan * 46 + 4.0 * broken) * smoothstep(-0.25, 0.35, fractal(dvec3(p.x * 9, p.y * 5, p.z * 2), 2, 42));
        dvec3 lipColour = glm::mix(rgb(186, 108, 98), rgb(172, 92, 86), smoothstep(-4.3, -4.1, p.y));
        lipColour *=
            1 + 0.05 * line + 0.06 * fractal(p * 3.0, 3, 43) - 0.18 * smoothstep(0.9, 1.0, t.weight[kLip]) * smoothstep(0.3, 1.5, hollow);
        colour = glm::mix(colour, lipColour, 0.88 * lip);
        colour = glm::mix(colour, rgb(96, 34, 32), mouth);
        colour = glm::mix(colour, rgb(74, 34, 28), 0.88 * glm::clamp(nostril, 0.0, 1.0));
        colour = glm::mix(colour, rgb(206, 132, 118), 0.75 * rim * byEye);

        // Hair: brows, the line that lashes grow from, and what is left of a close crop.
        double hair = brow.at(m);
        double root =
            byEye * smoothstep(0.10, 0.0, std::abs(toUpper)) * 0.75 * (1 - smoothstep(0.3, 0.7, rim)) * smoothstep(-0.95, -0.6, e.out);
        double bed = 0;
        for (double dy : {-0.2, 0.0, 0.2}) bed += brow.at(m + dvec3(0.1 * dy, dy, 0)) / 3;
        colour = glm::mix(colour, colour * dvec3(0.70, 0.62, 0.56), 0.55 * smoothstep(0.0, 0.5, bed));
        colour = glm::mix(colour, rgb(74, 52, 41), 0.55 * hair);  // the rest is hairs of its own: hair.cpp
        colour = glm::mix(colour, rgb(110, 70, 60), 0.40 * root);
        for (int c = 0; c < 3; ++c) put(skin.albedo, i, c, colour[c]);

        // What crying reddens: the rims of the lids and the skin around the eyes, the nose and its wings, the cheeks a little, the chin.
        double around = byEye * std::max(smoothstep(1.1, 0.05, toLower) * smoothstep(-0.2, 0.02, toLower), 0.7 * lid);
        double edge = byEye * std::max(smoothstep(0.16, 0.02, std::abs(toLower)), smoothstep(0.12, 0.02, std::abs(toUpper)));
        double flush = std::max({1.0 * rim * byEye, 0.85 * edge, 0.52 * around, 0.22 * corner, 0.85 * nose, 0.8 * wing, 0.45 * cheek,
                                 0.3 * chin, 0.25 * lip, 0.35 * bell(m, {0, 5.6, 5.6}, {2.2, 1.0, 2.0})});
        put(skin.flush, i, 0, flush * (0.75 + 0.35 * blotch + 0.25 * speck) * face);
        // Where lips meet, and in the mouth and the nostrils.
        double meets = lip * smoothstep(0.5, 0.85, std::abs(glm::normalize(t.normal).y));
        put(skin.flush, i, 1, std::max({smoothstep(0.02, 0.35, t.weight[kMouth]), 0.9 * meets, 0.8 * glm::clamp(nostril, 0.0, 1.0)}));

        // Relief, in mm.
        double pores =
            (0.35 + 0.9 * nose + 0.6 * cheek + 0.5 * wing + 0.35 * forehead + 0.4 * chin) * (1 - lip) * (1 - rim) * (1 - 0.7 * lid);
        double poreSize = 0.085, pore = cells(p / poreSize, 51, which);
        double height = -0.070 * pores * smoothstep(0.5, 0.1, pore) * (0.4 + 0.6 * which);
        height += 0.028 * fractal(p * 11.0, 3, 52) * (1 - lip);
        dvec3 bent = p + dvec3(0, 0.35 * fractal(p * 0.5, 2, 53), 0);
        height -=
            0.035 * forehead * std::pow(std::max(0.0, std::sin(bent.y * 2 * kPi / 0.95)), 8.0) * (0.6 + 0.8 * fractal(p * 0.8, 2, 54));
        double lines = toLower * 16 + 2.5 * fractal(p * 2.5, 3, 55);
        height -= 0.030 * under * std::pow(0.5 + 0.5 * std::sin(lines * 2.4), 4.0);
        height -= 0.025 * lid * std::pow(0.5 + 0.5 * std::sin(toUpper * 55 + 2 * fractal(p * 4.0, 2, 56)), 4.0);
        height += lip * (0.045 * line * (0.6 + 0.8 * fractal(p * 5.0, 2, 58)) + 0.03 * fractal(p * dvec3(16, 10, 16), 3, 57));
        height += 0.06 * hair;
        put(skin.relief, i, 0, (128 + height / kMillimetresPerStep) / 255.0);

        put(skin.regions, i, 0,
            std::max({forehead, smoothstep(0.25, 0.7, nose), bell(m, {0, 2.6, 5.6}, {0.7, 2.6, 1.5}), 0.6 * chin}) * (1 - lip));
        double dry =
            std::max(smoothstep(0.2, 0.7, cheek), smoothstep(-3.0, -5.0, p.y) * smoothstep(2.6, 4.0, m.x) * smoothstep(-3.0, -1.0, p.z));
        put(skin.regions, i, 1, dry * (1 - lip));
        put(skin.regions, i, 2, std::max({hair, root, crop}));
        put(skin.regions, i, 3, lip);
    }
    spreadOut(skin.albedo, covered, 12);
    spreadOut(skin.relief, covered, 6);
    if (!cheekSides.empty()) {
        std::nth_element(cheekSides.begin(), cheekSides.begin() + static_cast<std::ptrdiff_t>(cheekSides.size() / 2), cheekSides.end());
        skin.cheekMillimetres = cheekSides[cheekSides.size() / 2];
    }
    return skin;
}

Picture paintEye() {
    constexpr int kSize = 768;
    Picture eye = blank(kSize, 3);
    const double limbus = std::asin(kLimbusRadius / kEyeRadius);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const dvec2 at = (dvec2(x, kSize - 1 - y) + 0.5) / double{kSize};
            const dvec2 q = at - 0.5, place = (at - fleshUv(0, 0)) / (fleshUv(1, 1) - fleshUv(0, 0));
            if (std::max(place.x, place.y) < 1.04) {
                const dvec3 colour = fleshColour(glm::clamp(place, dvec2(0), dvec2(1)));
                for (int c = 0; c < 3; ++c) put(eye, static_cast<size_t>(y) * kSize + x, c, colour[c]);
                continue;
            }
            double angle = std::min(kPi, kPi * std::pow(2 * glm::length(q), 2.0)), turn = std::atan2(q.y, q.x), r = angle / limbus;
            dvec3 on(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle));
            // The white: warm towards the corners, with veins that thin out towards the iris.
            dvec3 colour = glm::mix(rgb(204, 194, 184), rgb(198, 160, 146), smoothstep(0.8, 2.0, angle));
            colour += 0.016 * fractal(on * 5.0, 3, 61);
            double wander = fractal(on * 3.5, 3, 62), vein = 1 - std::abs(fractal(on * 4.5 + wander * 0.8, 4, 63)) * 9;
            double fine = 1 - std::abs(fractal(on * 9.0 + wander, 3, 64)) * 8;
            double veins = std::max(0.0, vein) * 0.65 + std::max(0.0, fine) * 0.35;
            colour = glm::mix(colour, rgb(184, 76, 68), 0.55 * veins * smoothstep(0.58, 1.2, angle));
            // The iris: fibres along its radius, a warmer frill around the pupil, a soft dark ring at the limbus.
            double f = r;
            dvec3 around(std::cos(turn), std::sin(turn), 0.0);
            double fibre = fractal(dvec3(around.x * 22, around.y * 22, f * 1.6), 3, 65),
                   fork = fractal(dvec3(around.x * 9, around.y * 9, f * 3.0), 3, 66);
            double frill = std::exp(-std::pow((f - 0.47 - 0.05 * fork) / 0.10, 2.0));
            dvec3 iris = glm::mix(rgb(112, 86, 58), rgb(94, 98, 88), smoothstep(0.45, 0.75, f + 0.12 * fork));
            iris *= 1 + 0.60 * fibre + 0.28 * fork;
            iris = glm::mix(iris, rgb(146, 110, 70) * (1 + 0.5 * fibre), 0.5 * frill);
            iris *= 1 - 0.55 * smoothstep(0.70, 0.98, f);
            iris = glm::mix(rgb(9, 7, 7), iris, smoothstep(0.34, 0.40, f + 0.012 * fork));
            // Both eyes show this chart with the nose on its left.
            double corner = smoothstep(0.62, 1.05, angle) * smoothstep(-0.5, -0.95, std::cos(turn));
            colour = glm::mix(colour, kWhiteByCorner, 0.8 * corner);
            // The cornea's rim is clouded: the white runs over the iris.
            colour = glm::mix(iris, colour, smoothstep(0.86, 1.16, r + 0.03 * fork));
            for (int c = 0; c < 3; ++c) put(eye, static_cast<size_t>(y) * kSize + x, c, colour[c]);
        }
    return eye;
}

namespace {

void append(void* to, void* bytes, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(bytes), static_cast<size_t>(size));
}

}  // namespace

std::string asPng(const Picture& picture) {
    std::string bytes;
    stbi_write_png_to_func(append, &bytes, picture.width, picture.height, picture.channels, picture.bytes.data(),
                           picture.width * picture.channels);
    return bytes;
}

std::string asJpeg(const Picture& picture, int quality) {
    std::string bytes;
    stbi_write_jpg_to_func(append, &bytes, picture.width, picture.height, picture.channels, picture.bytes.data(), quality);
    return bytes;
}

}  // namespace rivulet::head
