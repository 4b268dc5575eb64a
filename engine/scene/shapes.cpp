#include "engine/scene/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hl {
namespace {

constexpr int kArchCharts = 8;

bool hasFace(const Shape& s, int face) {
  return s.faces.empty() || std::find(s.faces.begin(), s.faces.end(), kBoxFaces[face]) != s.faces.end();
}

int chartsOf(const Shape& s) {
  if (s.type == ShapeType::Icosphere) return 20;
  if (s.type == ShapeType::Arch) return kArchCharts;
  if (s.type != ShapeType::Box) return 1;
  int n = 0;
  for (int f = 0; f < 6; ++f) n += hasFace(s, f);
  return n;
}

class Builder {
 public:
  Builder(Scene& scene, bool lightmapUvs, int charts) : scene_(scene), lightmapUvs_(lightmapUvs) {
    while (side_ * side_ < charts) ++side_;
  }

  void begin(const Shape& s) {
    scene_.objects.push_back(s.name);
    object_ = static_cast<uint32_t>(scene_.objects.size() - 1);
  }
  void nextChart() { ++chart_; }

  /// `uv` in [0, 1]^2 is the place in the texture and, scaled into the cell, in the lightmap.
  uint32_t vertex(vec3 p, vec3 n, vec2 uv) {
    scene_.positions.push_back(p);
    scene_.normals.push_back(n);
    scene_.uvs.push_back(uv);
    if (lightmapUvs_) {
      const vec2 cell(static_cast<float>(chart_ % side_), static_cast<float>(chart_ / side_));
      const vec2 inside = vec2(kShapeChartMargin) + uv * (1 - 2 * kShapeChartMargin);
      scene_.lightmapUvs.push_back((cell + inside) / static_cast<float>(side_));
    }
    return static_cast<uint32_t>(scene_.positions.size() - 1);
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t material) {
    scene_.indices.push_back({a, b, c});
    scene_.materialIds.push_back(material);
    scene_.objectIds.push_back(object_);
  }
  /// A bilinear patch, front towards the side from which c0 c1 c2 c3 run counter-clockwise.
  void patch(const std::array<vec3, 4>& c, int n, uint32_t material) {
    const vec3 normal = glm::normalize(glm::cross(c[2] - c[0], c[3] - c[1]));
    std::vector<uint32_t> ids;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(n),
                    v = static_cast<float>(j) / static_cast<float>(n);
        ids.push_back(vertex(glm::mix(glm::mix(c[0], c[1], u), glm::mix(c[3], c[2], u), v), normal, vec2(u, v)));
      }
    const auto at = [&](int i, int j) { return ids[static_cast<size_t>(j * (n + 1) + i)]; };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1), material);
        triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1), material);
      }
    nextChart();
  }
  /// A flat or smooth facet of a sphere.
  void facet(const Shape& s, const std::array<vec3, 3>& directions, const std::array<vec2, 3>& uv, uint32_t material) {
    std::array<vec3, 3> p;
    for (size_t i = 0; i < 3; ++i) p[i] = s.centre + s.radius * directions[i];
    const float side = s.inward ? -1.0f : 1.0f;
    const vec3 flat = side * glm::normalize(glm::cross(directions[1] - directions[0], directions[2] - directions[0]));
    std::array<uint32_t, 3> ids{};
    for (size_t i = 0; i < 3; ++i) ids[i] = vertex(p[i], s.smooth ? side * directions[i] : flat, uv[i]);
    if (s.inward) std::swap(ids[1], ids[2]);
    triangle(ids[0], ids[1], ids[2], material);
  }

 private:
  Scene& scene_;
  bool lightmapUvs_;
  int side_ = 1, chart_ = 0;
  uint32_t object_ = 0;
};

void box(Builder& b, const Shape& s, const std::function<uint32_t(const std::string&)>& material) {
  for (int f = 0; f < 6; ++f) {
    if (!hasFace(s, f)) continue;
    const int axis = f / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    // u x v points along +axis, so the corners below run counter-clockwise seen from there.
    std::array<vec3, 4> c;
    for (size_t i = 0; i < 4; ++i) {
      c[i][axis] = f % 2 ? s.max[axis] : s.min[axis];
      c[i][u] = (i == 1 || i == 2) ? s.max[u] : s.min[u];
      c[i][v] = i >= 2 ? s.max[v] : s.min[v];
    }
    const bool towardsPlus = (f % 2 == 1) != s.inward;
    if (!towardsPlus) std::swap(c[1], c[3]);
    const auto own = s.faceMaterials.find(kBoxFaces[f]);
    b.patch(c, s.subdivisions, material(own == s.faceMaterials.end() ? s.material : own->second));
  }
}

void uvSphere(Builder& b, const Shape& s, uint32_t material) {
  const int rings = s.subdivisions, sectors = 2 * rings;
  const auto uvAt = [&](int i, int j) {
    return vec2(static_cast<float>(i) / static_cast<float>(sectors), static_cast<float>(j) / static_cast<float>(rings));
  };
  const auto direction = [&](int i, int j) {  // from the south pole up; a seam or pole comes out the same each time
    const double phi = 2 * 3.14159265358979323846 * (i % sectors) / sectors, theta = 3.14159265358979323846 * j / rings;
    const double r = j == 0 || j == rings ? 0.0 : std::sin(theta);
    return vec3(static_cast<float>(r * std::cos(phi)), static_cast<float>(-std::cos(theta)),
                static_cast<float>(-r * std::sin(phi)));
  };
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < sectors; ++i) {
      const vec3 p00 = direction(i, j), p10 = direction(i + 1, j), p11 = direction(i + 1, j + 1),
                 p01 = direction(i, j + 1);
      if (j > 0) b.facet(s, {p00, p10, p11}, {uvAt(i, j), uvAt(i + 1, j), uvAt(i + 1, j + 1)}, material);
      if (j + 1 < rings) b.facet(s, {p00, p11, p01}, {uvAt(i, j), uvAt(i + 1, j + 1), uvAt(i, j + 1)}, material);
    }
  b.nextChart();
}

void icosphere(Builder& b, const Shape& s, uint32_t material) {
  constexpr float g = 1.6180339887f;
  const std::array<vec3, 12> corners = {vec3(-1, g, 0), vec3(1, g, 0), vec3(-1, -g, 0), vec3(1, -g, 0),
                                        vec3(0, -1, g), vec3(0, 1, g), vec3(0, -1, -g), vec3(0, 1, -g),
                                        vec3(g, 0, -1), vec3(g, 0, 1), vec3(-g, 0, -1), vec3(-g, 0, 1)};
  constexpr std::array<std::array<uint8_t, 3>, 20> faces = {
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  const int n = s.subdivisions;
  for (const auto& face : faces) {
    // Integer weights, summed in the order of the corners' indices: neighbours get bit-identical points on a shared
    // edge.
    const auto direction = [&](int i, int j) {
      std::array<std::pair<int, int>, 3> terms = {{{face[0], n - i - j}, {face[1], i}, {face[2], j}}};
      std::sort(terms.begin(), terms.end());
      vec3 sum(0.0f);
      for (const auto& [corner, weight] : terms)
        sum += static_cast<float>(weight) * corners[static_cast<size_t>(corner)];
      return glm::normalize(sum);
    };
    const auto uvAt = [&](int i, int j) {
      return vec2(static_cast<float>(i), static_cast<float>(j)) / static_cast<float>(n);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        b.facet(s, {direction(i, j), direction(i + 1, j), direction(i, j + 1)},
                {uvAt(i, j), uvAt(i + 1, j), uvAt(i, j + 1)}, material);
        if (i + j + 1 < n)
          b.facet(s, {direction(i + 1, j), direction(i + 1, j + 1), direction(i, j + 1)},
                  {uvAt(i + 1, j), uvAt(i + 1, j + 1), uvAt(i, j + 1)}, material);
      }
    b.nextChart();
  }
}

void lathe(Builder& b, const Shape& s, uint32_t material) {
  const int rows = static_cast<int>(s.profile.size()) - 1, sectors = s.subdivisions;
  const auto direction = [&](int i) {  // the seam comes out the same from both sides
    const double phi = 2 * 3.14159265358979323846 * (i % sectors) / sectors;
    return vec3(static_cast<float>(std::cos(phi)), 0, static_cast<float>(-std::sin(phi)));
  };
  // A smooth normal is the mean of those of the pieces that meet, but not over an edge sharper than some 37 degrees.
  const auto slope = [&](int row) {
    const vec2 along = s.profile[static_cast<size_t>(row) + 1] - s.profile[static_cast<size_t>(row)];
    return glm::normalize(vec2(along.y, -along.x));
  };
  const auto normalAt = [&](int row, int end) {
    const int other = end == 0 ? row - 1 : row + 1;
    const vec2 own = slope(row);
    if (!s.smooth || other < 0 || other >= rows || glm::dot(own, slope(other)) < 0.8f) return own;
    return glm::normalize(own + slope(other));
  };
  for (int row = 0; row < rows; ++row) {
    std::vector<uint32_t> ids;
    for (int end = 0; end < 2; ++end) {
      const vec2 p = s.profile[static_cast<size_t>(row + end)], n = normalAt(row, end);
      for (int i = 0; i <= sectors; ++i) {
        const vec3 d = direction(i);
        ids.push_back(b.vertex(s.centre + vec3(p.x * d.x, p.y, p.x * d.z), glm::normalize(vec3(n.x * d.x, n.y, n.x * d.z)),
                               vec2(static_cast<float>(i) / static_cast<float>(sectors), static_cast<float>(row + end) / static_cast<float>(rows))));
      }
    }
    const auto at = [&](int end, int i) { return ids[static_cast<size_t>(end * (sectors + 1) + i)]; };
    const bool closedBelow = s.profile[static_cast<size_t>(row)].x == 0, closedAbove = s.profile[static_cast<size_t>(row) + 1].x == 0;
    for (int i = 0; i < sectors; ++i) {
      if (!closedBelow) b.triangle(at(0, i), at(0, i + 1), at(1, i + 1), material);
      if (!closedAbove) b.triangle(at(0, i), at(1, i + 1), at(1, i), material);
    }
  }
  b.nextChart();
}

/// Front and back, soffit, top, the two ends, the two feet.
void arch(Builder& b, const Shape& s, uint32_t material) {
  const float width = s.alongX ? s.max.x - s.min.x : s.max.z - s.min.z, height = s.max.y - s.min.y, half = 0.5f * width;
  const float thickness = s.alongX ? s.max.z - s.min.z : s.max.x - s.min.x;
  // In the wall's own frame: x from the opening's middle, y from its springing, z through the wall from its front. Left to right seen from the front.
  const auto place = [&](float x, float y, float z) {
    return s.alongX ? vec3(s.min.x + half + x, s.min.y + y, s.max.z - z) : vec3(s.max.x - z, s.min.y + y, s.max.z - half - x);
  };
  const auto turned = [&](vec3 n) { return s.alongX ? vec3(n.x, n.y, -n.z) : vec3(-n.z, n.y, -n.x); };
  std::vector<double> angles;  // from the right foot over the top to the left one; those of the corners among them
  for (int i = 0; i <= s.subdivisions; ++i) angles.push_back(3.14159265358979323846 * i / s.subdivisions);
  const double corner = std::atan2(static_cast<double>(height), static_cast<double>(half));
  for (const double a : {corner, 3.14159265358979323846 - corner})
    if (std::none_of(angles.begin(), angles.end(), [a](double known) { return std::abs(known - a) < 1e-6; })) angles.push_back(a);
  std::sort(angles.begin(), angles.end());
  const size_t n = angles.size();
  std::vector<vec2> inner, outer;
  for (size_t i = 0; i < n; ++i) {
    const float c = i == 0 ? 1 : i + 1 == n ? -1 : static_cast<float>(std::cos(angles[i]));
    const float t = i == 0 || i + 1 == n ? 0 : static_cast<float>(std::sin(angles[i]));
    inner.push_back(s.radius * vec2(c, t));
    const float reach = std::min(std::abs(c) > 1e-6f ? half / std::abs(c) : 1e30f, t > 1e-6f ? height / t : 1e30f);
    outer.push_back(reach * vec2(c, t));
  }
  const auto strip = [&](const std::vector<vec3>& right, const std::vector<vec3>& left, const std::vector<vec3>& normals) {
    std::vector<uint32_t> ids;
    const auto share = [&](size_t i) { return static_cast<float>(i) / static_cast<float>(right.size() - 1); };
    for (size_t i = 0; i < right.size(); ++i) ids.push_back(b.vertex(right[i], normals[i], vec2(0, share(i)))), ids.push_back(b.vertex(left[i], normals[i], vec2(1, share(i))));
    for (size_t i = 0; i + 1 < right.size(); ++i) {
      b.triangle(ids[2 * i], ids[2 * i + 1], ids[2 * i + 3], material);
      b.triangle(ids[2 * i], ids[2 * i + 3], ids[2 * i + 2], material);
    }
    b.nextChart();
  };
  std::vector<vec3> innerFront, innerBack, outerFront, outerBack, towards;
  for (size_t i = 0; i < n; ++i) {
    innerFront.push_back(place(inner[i].x, inner[i].y, 0)), innerBack.push_back(place(inner[i].x, inner[i].y, thickness));
    outerFront.push_back(place(outer[i].x, outer[i].y, 0)), outerBack.push_back(place(outer[i].x, outer[i].y, thickness));
    towards.push_back(turned(vec3(-inner[i].x / s.radius, -inner[i].y / s.radius, 0)));
  }
  const std::vector<vec3> front(n, turned(vec3(0, 0, -1))), back(n, turned(vec3(0, 0, 1)));
  strip(innerFront, outerFront, front);
  strip(outerBack, innerBack, back);
  strip(innerBack, innerFront, towards);
  const auto face = [&](vec3 p0, vec3 p1, vec3 p2, vec3 p3) { b.patch({p0, p1, p2, p3}, 1, material); };
  face(place(-half, height, 0), place(half, height, 0), place(half, height, thickness), place(-half, height, thickness));
  face(place(half, 0, 0), place(half, 0, thickness), place(half, height, thickness), place(half, height, 0));
  face(place(-half, 0, thickness), place(-half, 0, 0), place(-half, height, 0), place(-half, height, thickness));
  face(place(s.radius, 0, thickness), place(half, 0, thickness), place(half, 0, 0), place(s.radius, 0, 0));
  face(place(-half, 0, thickness), place(-s.radius, 0, thickness), place(-s.radius, 0, 0), place(-half, 0, 0));
}

void cloth(Builder& b, const Shape& s, uint32_t material) {
  const int n = s.subdivisions;
  const vec3 doubled = glm::cross(s.corners[2] - s.corners[0], s.corners[3] - s.corners[1]);
  const auto unit = [](vec3 v) { return glm::length(v) > 0 ? glm::normalize(v) : vec3(0, 1, 0); };  // corners in one place or in a line
  const vec3 normal = unit(doubled);
  const auto at = [&](float u, float v) {
    const vec3 flat = glm::mix(glm::mix(s.corners[0], s.corners[1], u), glm::mix(s.corners[3], s.corners[2], u), v);
    // Folds are shallow where the cloth hangs from its second edge, and the lower they are the deeper, each a little unlike the next.
    const float wave = std::sin(2 * kPi * static_cast<float>(s.folds) * u + 0.6f * std::sin(5.1f * u)) * (0.25f + 0.75f * (1 - v));
    return flat + normal * (s.depth * wave) - vec3(0, s.sag * 4 * u * (1 - u), 0);
  };
  const float h = 1e-3f;
  std::vector<uint32_t> ids;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(n), v = static_cast<float>(j) / static_cast<float>(n);
      const vec3 across = glm::cross(at(u + h, v) - at(u - h, v), at(u, v + h) - at(u, v - h));
      ids.push_back(b.vertex(at(u, v), unit(across), vec2(u, v)));
    }
  const auto id = [&](int i, int j) { return ids[static_cast<size_t>(j * (n + 1) + i)]; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      b.triangle(id(i, j), id(i + 1, j), id(i + 1, j + 1), material);
      b.triangle(id(i, j), id(i + 1, j + 1), id(i, j + 1), material);
    }
  b.nextChart();
}

}  // namespace

void appendShapes(Scene& scene, const std::vector<Shape>& shapes, bool lightmapUvs,
                  const std::function<uint32_t(const std::string&)>& material) {
  int charts = 0;
  for (const Shape& s : shapes) charts += chartsOf(s);
  Builder b(scene, lightmapUvs, charts);
  for (const Shape& s : shapes) {
    b.begin(s);
    switch (s.type) {
      case ShapeType::Quad:
        b.patch({s.corners[0], s.corners[1], s.corners[2], s.corners[3]}, s.subdivisions, material(s.material));
        break;
      case ShapeType::Box:
        box(b, s, material);
        break;
      case ShapeType::UvSphere:
        uvSphere(b, s, material(s.material));
        break;
      case ShapeType::Icosphere:
        icosphere(b, s, material(s.material));
        break;
      case ShapeType::Lathe:
        lathe(b, s, material(s.material));
        break;
      case ShapeType::Arch:
        arch(b, s, material(s.material));
        break;
      case ShapeType::Cloth:
        cloth(b, s, material(s.material));
        break;
    }
  }
  if (!shapes.empty()) scene.hasUvs = true;
}

}  // namespace hl
