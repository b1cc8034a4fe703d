// Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem & Fairchild 2020 "FLIP: a difference evaluator for alternating images".
#include "fluid/validate/image_flip.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/core/assert.h"
#include "engine/core/math.h"

namespace rivulet {

namespace {

// The paper's constants.
constexpr double kColourExponent = 0.7, kColourKnee = 0.4, kColourAtKnee = 0.95;
constexpr double kFeatureExponent = 0.5, kFeatureWidth = 0.082;  // deg
const dvec3 kWhite(0.950428545, 1.000000000, 1.088900371);       // XYZ of D65

// A channel's contrast sensitivity: sums of two Gaussians, a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
    double a[2], b[2];
};
constexpr Sensitivity kSensitivity[3] = {
    {{1, 0}, {0.0047, 1e-5}}, {{1, 0}, {0.0053, 1e-5}}, {{34.1, 13.5}, {0.04, 0.025}}};  // luminance, red-green, blue-yellow

struct FlipImage {
    int width, height;
    std::vector<dvec3> texels;
    const dvec3& at(int x, int y) const {
        return texels[static_cast<size_t>(std::clamp(y, 0, height - 1)) * static_cast<size_t>(width) +
                      static_cast<size_t>(std::clamp(x, 0, width - 1))];
    }
};

FlipImage mapped(FlipImage image, const std::function<dvec3(const dvec3&)>& f) {
    for (dvec3& texel : image.texels) texel = f(texel);
    return image;
}

double linearOf(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

dvec3 xyzOf(const dvec3& c) {
    return {(10135552.0 * c.x + 8788810.0 * c.y + 4435075.0 * c.z) / 24577794.0,
            (2613072.0 * c.x + 8788810.0 * c.y + 887015.0 * c.z) / 12288897.0,
            (1425312.0 * c.x + 8788810.0 * c.y + 70074185.0 * c.z) / 73733382.0};
}
dvec3 rgbOf(const dvec3& xyz) {
    // The columns are the XYZ values of red, green and blue.
    static const dmat3 back = glm::inverse(dmat3(xyzOf({1, 0, 0}), xyzOf({0, 1, 0}), xyzOf({0, 0, 1})));
    return back * xyz;
}
dvec3 opponentOf(const dvec3& rgb) {  // YCxCz: a linear space, in which contrast is filtered
    const dvec3 r = xyzOf(rgb) / kWhite;
    return {116 * r.y - 16, 500 * (r.x - r.y), 200 * (r.y - r.z)};
}
dvec3 rgbOfOpponent(const dvec3& o) {
    const double y = (o.x + 16) / 116;
    return rgbOf(dvec3(o.y / 500 + y, y, y - o.z / 200) * kWhite);
}
dvec3 labOf(const dvec3& rgb) {  // CIELab, with chroma reduced in dark areas (Hunt effect)
    const dvec3 r = xyzOf(rgb) / kWhite;
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : t * 841 / 108 + 4.0 / 29; };
    const double l = 116 * f(r.y) - 16;
    return {l, 0.01 * l * 500 * (f(r.x) - f(r.y)), 0.01 * l * 200 * (f(r.y) - f(r.z))};
}
double hyab(const dvec3& a, const dvec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// A separable filter with weights at -reach .. reach; border pixels are repeated.
FlipImage filtered(const FlipImage& image, const std::vector<dvec3>& alongX, const std::vector<dvec3>& alongY) {
    FlipImage half = image, whole = image;
    const int reachX = static_cast<int>(alongX.size() / 2), reachY = static_cast<int>(alongY.size() / 2);
    for (const bool first : {true, false}) {
        const FlipImage& from = first ? image : half;
        FlipImage& to = first ? half : whole;
        size_t i = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x, ++i) {
                dvec3 sum(0.0);
                if (first)
                    for (int k = -reachX; k <= reachX; ++k) sum += alongX[static_cast<size_t>(k + reachX)] * from.at(x + k, y);
                else
                    for (int k = -reachY; k <= reachY; ++k) sum += alongY[static_cast<size_t>(k + reachY)] * from.at(x, y + k);
                to.texels[i] = sum;
            }
    }
    return whole;
}

// Opponent colours after the contrast sensitivity of the eye at this resolution.
FlipImage seen(const FlipImage& opponent, double ppd) {
    const int reach = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * glm::pi<double>() * glm::pi<double>())) * ppd));
    std::vector<dvec3> terms[2];
    dvec3 scale[2], total(0.0);
    for (int t = 0; t < 2; ++t) {
        dvec3 sum(0.0);
        for (int k = -reach; k <= reach; ++k) {
            dvec3 w;
            for (int c = 0; c < 3; ++c) w[c] = std::exp(-std::pow(glm::pi<double>() * k / ppd, 2) / kSensitivity[c].b[t]);
            terms[t].push_back(w);
            sum += w;
        }
        for (int c = 0; c < 3; ++c) scale[t][c] = kSensitivity[c].a[t] * std::sqrt(glm::pi<double>() / kSensitivity[c].b[t]);
        total += scale[t] * sum * sum;
    }
    FlipImage all = filtered(opponent, terms[0], terms[0]);
    const FlipImage second = filtered(opponent, terms[1], terms[1]);
    for (size_t i = 0; i < all.texels.size(); ++i) all.texels[i] = (scale[0] * all.texels[i] + scale[1] * second.texels[i]) / total;
    return all;
}

// The strength of edges and points of the luminance at each pixel.
struct Features {
    std::vector<double> edge, point;
};
Features featuresOf(const FlipImage& opponent, double ppd) {
    const double deviation = 0.5 * kFeatureWidth * ppd;
    const int reach = static_cast<int>(std::ceil(3 * deviation));
    std::vector<dvec3> smooth, edge, point;
    double sums[4] = {};  // of the Gaussian, the edge's positive half, the point's positive and negative parts
    for (int k = -reach; k <= reach; ++k) {
        const double g = std::exp(-0.5 * k * k / (deviation * deviation)), e = -k * g, p = (k * k / (deviation * deviation) - 1) * g;
        smooth.emplace_back(g);
        edge.emplace_back(e);
        point.emplace_back(p);
        sums[0] += g;
        sums[1] += std::max(e, 0.0);
        (p > 0 ? sums[2] : sums[3]) += std::abs(p);
    }
    for (size_t k = 0; k < smooth.size(); ++k) {
        smooth[k] /= sums[0];
        edge[k] /= sums[1];
        point[k] /= point[k].x > 0 ? sums[2] : sums[3];
    }
    const FlipImage y = mapped(opponent, [](const dvec3& o) { return dvec3((o.x + 16) / 116); });
    const FlipImage edgeX = filtered(y, edge, smooth), edgeY = filtered(y, smooth, edge), pointX = filtered(y, point, smooth),
                    pointY = filtered(y, smooth, point);
    Features f;
    for (size_t i = 0; i < y.texels.size(); ++i) {
        f.edge.push_back(std::hypot(edgeX.texels[i].x, edgeY.texels[i].x));
        f.point.push_back(std::hypot(pointX.texels[i].x, pointY.texels[i].x));
    }
    return f;
}

struct Prepared {
    FlipImage lab;
    Features features;
};
Prepared prepare(std::span<const uint8_t> rgba, int width, int height, double ppd) {
    FlipImage image{width, height, {}};
    for (size_t i = 0; i + 3 < rgba.size(); i += 4) {
        dvec3 c;
        for (int k = 0; k < 3; ++k) c[k] = linearOf(rgba[i + static_cast<size_t>(k)] / 255.0);
        image.texels.push_back(opponentOf(c));
    }
    Features features = featuresOf(image, ppd);
    FlipImage lab = mapped(seen(image, ppd), [](const dvec3& o) { return labOf(glm::clamp(rgbOfOpponent(o), 0.0, 1.0)); });
    return {std::move(lab), std::move(features)};
}

// A colour difference mapped to 0 to 1, with small differences expanded.
double spread(double difference) {
    static const double most = std::pow(hyab(labOf({0, 1, 0}), labOf({0, 0, 1})), kColourExponent);
    const double d = std::pow(difference, kColourExponent), knee = kColourKnee * most;
    return d < knee ? kColourAtKnee / knee * d : kColourAtKnee + (d - knee) / (most - knee) * (1 - kColourAtKnee);
}

}  // namespace

std::vector<float> flipMap(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height, double ppd) {
    const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    ASSERT(reference.size() == 4 * pixels && test.size() == 4 * pixels, "both pictures have 4 bytes a pixel and this size");
    const Prepared a = prepare(reference, width, height, ppd), b = prepare(test, width, height, ppd);
    std::vector<float> map(pixels);
    for (size_t i = 0; i < pixels; ++i) {
        const double colour = spread(hyab(a.lab.texels[i], b.lab.texels[i]));
        const double feature =
            std::max(std::abs(a.features.edge[i] - b.features.edge[i]), std::abs(a.features.point[i] - b.features.point[i]));
        map[i] = static_cast<float>(std::pow(colour, 1 - std::pow(std::min(feature / std::sqrt(2.0), 1.0), kFeatureExponent)));
    }
    return map;
}

double flipMean(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height, double ppd) {
    double sum = 0;
    for (const float f : flipMap(reference, test, width, height, ppd)) sum += double{f};
    return sum / std::max(static_cast<double>(width) * height, 1.0);
}

}  // namespace rivulet
