#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "firmware/model/gjk.h"
#include "firmware/model/load/capsule_fit.h"
#include "firmware/model/load/mesh_distance.h"
#include "firmware/model/load/pieces_cache.h"
#include "host/sim/solid.h"
#include "tests/support/check.h"
#include "tests/support/random.h"
#include "tests/support/scratch.h"

using namespace sidestep;
using test::message_of;
using test::one_line_with;
using test::Random;
using test::scratch_file;
using test::scratch_folder;

namespace {

/// Triangles with corners at random, long ones too, in a block of the given edges.
Mesh random_mesh(Random& random, const Vector3& edges_m, int triangles) {
  Mesh mesh;
  for (int i = 0; i < triangles; ++i) {
    for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back(random.inside(-0.5, 0.5).cwiseProduct(edges_m));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// An OBJ file of a block with its lower corner at the origin.
std::string block(const std::string& name, const Vector3& edges_m) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += "v " + std::to_string((i & 1) * edges_m.x()) + " " + std::to_string((i >> 1 & 1) * edges_m.y()) + " " +
            std::to_string((i >> 2) * edges_m.z()) + "\n";
  return scratch_file(name, text + "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n");
}

/// How far a point is outside of all pieces, m.
double outside_m(const MeshPieces& split, const Vector3& p) {
  double least_m = 1e9;
  for (const MeshPiece& piece : split.pieces) {
    ConvexSolid solid;
    solid.kind = CoreKind::kPolyhedron;
    solid.polyhedron = piece.polyhedron.get();
    solid.radius_m = piece.radius_m;
    least_m = std::min(least_m, gap_between(solid, ConvexSolid::of(Capsule{p, p, 0.0}), -p).distance_m);
  }
  return least_m;
}

void every_point_of_every_triangle_is_enclosed(void**) {
  Random random(1);
  for (int trial = 0; trial < 5; ++trial) {
    const Vector3 edges_m = random.inside(0.01, 0.6);
    const Mesh mesh = random_mesh(random, edges_m, trial == 0 ? 1 : 40);
    for (int most : {1, 3}) {
      const MeshPieces split = split_mesh(mesh, most);
      check(split.pieces.size() <= static_cast<size_t>(most), "%zu pieces", split.pieces.size());
      for (const auto& [a, b, c] : mesh.triangles)
        for (int i = 0; i <= 6; ++i)
          for (int j = 0; j <= 6 - i; ++j) {
            const Vector3 p = (i * mesh.vertices[static_cast<size_t>(a)] + j * mesh.vertices[static_cast<size_t>(b)] +
                               (6 - i - j) * mesh.vertices[static_cast<size_t>(c)]) /
                              6.0;
            check(outside_m(split, p) <= 1e-9, "trial %d: %g m outside", trial, outside_m(split, p));
          }
    }
  }
}

/// The points of the pieces' surfaces that lie in no other piece, by hulls of their own, at random and dense.
double largest_excess_m(const MeshPieces& split, const Mesh& mesh, Random& random) {
  const MeshDistance distance(mesh);
  std::vector<ConvexHull> hulls;
  for (const MeshPiece& piece : split.pieces) hulls.push_back(convex_hull(piece.polyhedron->vertices));
  double largest_m = 0.0;
  for (size_t i = 0; i < hulls.size(); ++i)
    for (const ConvexHull::Face& face : hulls[i].faces) {
      const auto corner = [&](size_t k) { return hulls[i].vertices[static_cast<size_t>(face.corners[k])]; };
      const double area_m2 = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
      for (int sample = 0; sample < area_m2 / 2e-6; ++sample) {
        double u = random.uniform(0.0, 1.0), v = random.uniform(0.0, 1.0);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        const Vector3 p = corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0)) +
                          split.pieces[i].radius_m * face.normal;
        bool is_inside = false;
        for (size_t other = 0; other < hulls.size(); ++other)
          is_inside |= other != i && hulls[other].outside_m(p) < split.pieces[other].radius_m;
        if (!is_inside) largest_m = std::max(largest_m, distance.to_m(p));
      }
    }
  return largest_m;
}

void the_largest_excess_is_that_of_any_point_of_the_surface(void**) {
  Random random(6);
  for (int trial = 0; trial < 6; ++trial) {
    const Mesh mesh = random_mesh(random, {0.3, 0.2, 0.2}, 6);
    const MeshPieces split = split_mesh(mesh, 4);
    const double found_m = largest_excess_m(split, mesh, random);
    check(split.excess_m > found_m - 5e-4, "trial %d: %g m, but %g m somewhere", trial, split.excess_m, found_m);
  }
}

/// More vertices than a polyhedron keeps: the rounding radius covers what is left out.
void a_fine_ball_is_enclosed_by_few_vertices_and_a_small_radius(void**) {
  Random random(4);
  Mesh mesh;
  for (int i = 0; i < 1500; ++i) mesh.vertices.push_back(0.1 * random.direction());
  const ConvexHull hull = convex_hull(mesh.vertices);
  mesh.vertices = hull.vertices;
  for (const ConvexHull::Face& face : hull.faces) mesh.triangles.push_back(face.corners);
  const MeshPieces split = split_mesh(mesh, 1);
  const MeshPiece& piece = split.pieces.front();
  check(piece.polyhedron->vertices.size() <= static_cast<size_t>(kMostVertices), "%zu",
        piece.polyhedron->vertices.size());
  check(piece.radius_m > 1e-4 && piece.radius_m < 6e-3, "radius %g", piece.radius_m);
  check(split.excess_m < 6e-3, "excess %g", split.excess_m);
  for (const Vector3& p : mesh.vertices) check(outside_m(split, p) <= 1e-9, "%g m outside", outside_m(split, p));
}

void points_on_a_capsule_give_that_capsule(void**) {
  Random random(2);
  std::vector<Vector3> points;
  const Vector3 axis = Vector3(1, 2, 3).normalized();
  for (int i = 0; i < 3000; ++i) {
    const double along_m = random.inside(-0.2, 0.2).x();
    points.push_back(along_m * axis + 0.05 * random.inside(-1, 1).normalized());
  }
  const Capsule found = capsule_around(points);
  check(found.radius_m < 0.052, "radius %g", found.radius_m);
  check((found.end - found.start).norm() < 0.41, "length %g", (found.end - found.start).norm());
  check((found.end - found.start).normalized().cross(axis).norm() < 0.01, "tilted");
}

void a_bent_mesh_is_cut_where_it_bends(void**) {
  Mesh bent = load_mesh(block("one.obj", {0.6, 0.1, 0.1}), {1, 1, 1});
  const Mesh other = load_mesh(block("two.obj", {0.1, 0.1, 0.3}), {1, 1, 1});
  const int first = static_cast<int>(bent.vertices.size());
  bent.vertices.insert(bent.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) bent.triangles.push_back({a + first, b + first, c + first});
  const MeshPieces one = split_mesh(bent, 1), more = split_mesh(bent, 8);
  assert_int_equal(one.pieces.size(), 1);
  check(one.excess_m > 0.05, "%g", one.excess_m);
  check(more.pieces.size() <= 3 && more.excess_m < 0.01, "%zu pieces, excess %g", more.pieces.size(), more.excess_m);
}

void meshes_are_read_and_scaled(void**) {
  const std::string stl = scratch_file("one.stl",
                                       "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1000 0 0\n"
                                       "vertex 0 500 0\nendloop\nendfacet\nendsolid s\n");
  const std::string dae = scratch_file(
      "one.dae",
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1000 0 0 0 500 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene>
</COLLADA>)");
  for (const auto& [file, scale] : {std::pair(stl, 0.001), std::pair(dae, 1.0)}) {
    const Mesh mesh = load_mesh(file, {scale, 2 * scale, scale});
    Vector3 upper = Vector3::Zero();
    for (const Vector3& p : mesh.vertices) upper = upper.cwiseMax(p);
    check_near_because(upper, Vector3(1, 1, 0), 1e-6, "%s", file.c_str());
  }
}

void a_package_is_searched_on_the_path_and_above_the_urdf(void**) {
  namespace fs = std::filesystem;
  fs::create_directories(scratch_folder() + "/share/arms/meshes");
  fs::create_directories(scratch_folder() + "/share/arms/urdf");
  const std::string mesh = scratch_file("share/arms/meshes/a.obj", "v 0 0 0\n");
  const std::string above = scratch_folder() + "/share/arms/urdf/arm.urdf", name = "package://arms/meshes/a.obj";
  assert_true(fs::equivalent(find_mesh(name, above, {}), mesh));
  assert_true(fs::equivalent(find_mesh(name, "urdf/lwa3.urdf", {scratch_folder() + "/share"}), mesh));
  assert_true(fs::equivalent(find_mesh(name, "urdf/lwa3.urdf", {scratch_folder() + "/share/arms"}), mesh));
  assert_true(fs::equivalent(find_mesh("meshes/a.obj", above, {}), mesh));
  assert_true(fs::equivalent(find_mesh("file://" + mesh, "urdf/lwa3.urdf", {}), mesh));
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + scratch_folder() + "/share").c_str(), 1);
  assert_true(fs::equivalent(find_mesh(name, "urdf/lwa3.urdf", {}), mesh));
  unsetenv("ROS_PACKAGE_PATH");
  assert_true(one_line_with(message_of([&] { find_mesh(name, "urdf/lwa3.urdf", {}); }), {name, "package_path"}));
  for (const char* odd : {"package://", "package:///", "", "package://.."})
    check(!message_of([&] { find_mesh(odd, above, {}); }).empty(), "'%s' was found", odd);
}

void a_bad_mesh_is_refused_with_one_line(void**) {
  const std::string good = test::text_of(block("good.obj", {1, 1, 1}));
  const std::pair<const char*, std::string> bad[] = {
      {"empty.stl", ""},
      {"empty.obj", ""},
      {"empty.dae", ""},
      {"zeros.stl", std::string(500, '\0')},
      {"many.stl", std::string(80, 'x') + "\xff\xff\xff\x7f" + std::string(50, 'x')},
      {"point.obj", "v 0 0 0\n"},
      {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"huge.obj", "v 1e9 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"no_corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n"},
      {"words.dae", "<COLLADA><"},
      {"arm.ply", good},
  };
  for (const auto& [name, text] : bad) {
    const std::string file = scratch_file(name, text);
    const std::string message = message_of([&] { load_mesh(file, {1, 1, 1}); });
    check(one_line_with(message, {file}), "%s: '%s'", name, message.c_str());
  }
  const std::string file = block("good.obj", {1, 1, 1});
  for (double scale : {0.0, std::nan(""), 1e9})
    check(one_line_with(message_of([&] { load_mesh(file, {1, scale, 1}); }), {file}), "scale %g", scale);
  assert_true(one_line_with(message_of([] { load_mesh("no/such.stl", {1, 1, 1}); }), {"no/such.stl"}));
}

void a_damaged_cache_entry_is_computed_and_written_again(void**) {
  namespace fs = std::filesystem;
  setenv("XDG_CACHE_HOME", (scratch_folder() + "/cache").c_str(), 1);
  const Mesh mesh = load_mesh(block("cached.obj", {0.5, 0.1, 0.2}), {1, 1, 1});
  const MeshPieces fresh = split_mesh_cached(mesh, 3);
  const fs::path file = fs::directory_iterator(scratch_folder() + "/cache/sidestep")->path();
  const std::string text = test::text_of(file.string());
  std::string altered = text;
  altered[40] = altered[40] == '1' ? '2' : '1';
  for (const std::string& broken :
       {std::string(), std::string("nonsense\n"), text.substr(0, text.size() / 2), altered}) {
    std::ofstream(file) << broken;
    check_near(split_mesh_cached(mesh, 3).pieces.front().radius_m, fresh.pieces.front().radius_m, 0.0);
    check(test::text_of(file.string()) == text, "not written again after '%s'", broken.c_str());
  }
  setenv("XDG_CACHE_HOME", "/proc/nowhere", 1);
  check_near(split_mesh_cached(mesh, 3).excess_m, fresh.excess_m, 0.0);
}

void the_simulator_measures_distances_to_the_mesh_itself(void**) {
  const auto [solid, centre_m] =
      sim::load_mesh_solid("file://" + block("truth.obj", {0.4, 0.2, 0.1}), "x.urdf", {}, {1, 1, 1});
  check_near(centre_m, Vector3(0.2, 0.1, 0.05), 1e-6);
  const sim::Solid as_box{sim::Shape::kBox, {0.4, 0.2, 0.1}};
  const sim::Solid others[] = {{sim::Shape::kSphere, {0.05, 0, 0}}, {sim::Shape::kCapsule, {0.05, 0.3, 0}}};
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d pose =
        Eigen::Translation3d(random.inside(-0.5, 0.5)) * Eigen::AngleAxisd(i, random.inside(-1, 1).normalized());
    for (const sim::Solid& other : others) {
      const double expected_m = sim::signed_distance_m(as_box, Eigen::Isometry3d::Identity(), other, pose);
      const double found_m = sim::signed_distance_m(solid, Eigen::Isometry3d::Identity(), other, pose);
      if (expected_m > 0.0) check_near(found_m, expected_m, 1e-5);
      if (expected_m < 0.0 && expected_m > -0.04) check(found_m <= 1e-12, "%g, should be %g", found_m, expected_m);
    }
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_point_of_every_triangle_is_enclosed),
      cmocka_unit_test(the_largest_excess_is_that_of_any_point_of_the_surface),
      cmocka_unit_test(a_fine_ball_is_enclosed_by_few_vertices_and_a_small_radius),
      cmocka_unit_test(points_on_a_capsule_give_that_capsule),
      cmocka_unit_test(a_bent_mesh_is_cut_where_it_bends),
      cmocka_unit_test(meshes_are_read_and_scaled),
      cmocka_unit_test(a_package_is_searched_on_the_path_and_above_the_urdf),
      cmocka_unit_test(a_bad_mesh_is_refused_with_one_line),
      cmocka_unit_test(a_damaged_cache_entry_is_computed_and_written_again),
      cmocka_unit_test(the_simulator_measures_distances_to_the_mesh_itself),
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
