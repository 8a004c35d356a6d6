#include "firmware/model/load/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "firmware/base/find_file.h"

namespace sidestep {
namespace {

namespace fs = std::filesystem;

constexpr double kLargest_m = 100.0;
constexpr std::uintmax_t kLargestFile_bytes = 256u << 20;

/// The folder that contains a file, as an absolute path without `..`.
std::string folder_of(const std::string& file) {
  return fs::absolute(file).parent_path().lexically_normal().string();
}

/// The folders in which find_mesh() searches for a package, in its order.
std::vector<fs::path> package_folders(const std::string& urdf_file, const std::vector<std::string>& package_path) {
  std::vector<fs::path> folders(package_path.begin(), package_path.end());
  const char* const variable = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream entries(variable ? variable : "");
  for (std::string entry; std::getline(entries, entry, ':');)
    if (!entry.empty()) folders.emplace_back(entry);
  for (std::string above = folder_of(urdf_file); !above.empty(); above = folder_above(above))
    folders.emplace_back(above);
  return folders;
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

std::string extension_of(const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void check_file(const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension != ".stl" && extension != ".dae" && extension != ".obj")
    throw std::runtime_error(fmt::format("{}: a mesh must be an STL, DAE or OBJ file", file));
  if (!is_file(file)) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  std::error_code ignored;
  if (fs::file_size(file, ignored) > kLargestFile_bytes)
    throw std::runtime_error(fmt::format("{}: a mesh of more than {} MB", file, kLargestFile_bytes >> 20));
}

/// Adds the triangles of a part of the scene and their corners. Points and lines enclose nothing and are skipped.
void append(Mesh& mesh, const aiMesh& part, const Vector3& scale) {
  std::vector<int> index(part.mNumVertices, -1);
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;
    std::array<int, 3> triangle{};
    for (unsigned corner = 0; corner < 3; ++corner) {
      const unsigned v = face.mIndices[corner];
      if (v >= part.mNumVertices) throw std::runtime_error("a triangle has no such corner");
      if (index[v] < 0) {
        index[v] = static_cast<int>(mesh.vertices.size());
        const aiVector3D& p = part.mVertices[v];
        mesh.vertices.push_back(Vector3(p.x, p.y, p.z).cwiseProduct(scale));
        if (!(mesh.vertices.back().cwiseAbs().maxCoeff() <= kLargest_m))
          throw std::runtime_error(fmt::format("a corner is not within {} m", kLargest_m));
      }
      triangle[corner] = index[v];
    }
    mesh.triangles.push_back(triangle);
  }
}

}  // namespace

std::string find_mesh(const std::string& name, const std::string& urdf_file,
                      const std::vector<std::string>& package_path) {
  if (const std::string file = "file://"; starts_with(name, file)) return name.substr(file.size());
  const std::string package = "package://";
  if (!starts_with(name, package)) {
    if (std::string found = find_upwards(folder_of(urdf_file), name); !found.empty()) return found;
    throw std::runtime_error(fmt::format("mesh '{}' is in no folder from that of the URDF upwards", name));
  }
  const fs::path whole = name.substr(package.size());
  const fs::path rest = whole.lexically_relative(*whole.begin());
  for (const fs::path& folder : package_folders(urdf_file, package_path)) {
    if (is_file((folder / whole).string())) return (folder / whole).string();
    if (folder.filename() == *whole.begin() && is_file((folder / rest).string())) return (folder / rest).string();
  }
  throw std::runtime_error(
      fmt::format("mesh '{}' is neither on robot.package_path, nor on ROS_PACKAGE_PATH, nor above the URDF", name));
}

Mesh load_mesh(const std::string& file, const Vector3& scale) {
  check_file(file);
  if (!scale.allFinite() || (scale.array() == 0.0).any())
    throw std::runtime_error(fmt::format("{}: the scale of a mesh must be finite and not zero", file));
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // Vertices that differ only in their normals, colours and the like are joined.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                          aiComponent_COLORS | aiComponent_TEXCOORDS |
                                                          aiComponent_BONEWEIGHTS | aiComponent_MATERIALS);
  const aiScene* const scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices |
                                  aiProcess_PreTransformVertices);
  if (!scene) {
    const std::string reason = importer.GetErrorString();
    throw std::runtime_error(fmt::format("{}: not a mesh: {}", file, reason.substr(0, reason.find('\n'))));
  }
  Mesh mesh;
  try {
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(mesh, *scene->mMeshes[i], scale);
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", file, error.what()));
  }
  if (mesh.triangles.empty()) throw std::runtime_error(fmt::format("{}: a mesh without triangles", file));
  return mesh;
}

}  // namespace sidestep
