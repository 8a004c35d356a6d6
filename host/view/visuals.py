"""The visual meshes of an arm: those that its URDF names, else those of the same robot in PyPI's example-robot-data.

That package is not required: without it, or without meshes, the arm is drawn by its collision shapes.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import numpy as np

import arm

SHARE = "lib/python3*/site-packages/cmeel.prefix/share"  # of packages made by cmeel, below sys.prefix


class Visual(NamedTuple):
    """A mesh file with its pose in the frame of its link."""
    frame: int            # index of the link in arm.link_poses()
    file: Path
    scale: np.ndarray     # 3, along the axes of the mesh
    position: np.ndarray  # 3, m
    rotation: np.ndarray  # 3x3


def mesh_file(name, urdf, package_path=()):
    """The file that a URDF names, or None. package://PACKAGE/FILE is searched below package_path and above the URDF."""
    scheme, _, path = name.rpartition("://")
    if scheme == "package":
        roots = [*map(Path, package_path), *Path(urdf).absolute().parents]
        return next((root / path for root in roots if (root / path).is_file()), None)
    file = Path(urdf).absolute().parent / path
    return file if file.is_file() else None


def packaged(urdf):
    """The URDF of the robot of the same name in example-robot-data, or None."""
    name = ElementTree.parse(urdf).getroot().get("name")
    found = Path(sys.prefix).glob(f"{SHARE}/example-robot-data/robots/{name}_description/urdf/{name}.urdf")
    return next(found, None)


def named_in(links, names, urdf, package_path=()):
    """links: elements by name, of the URDF file `urdf`. names: of the chain's links, from the base on."""
    found = []
    for frame, name in enumerate(names):
        for visual in links[name].findall("visual") if name in links else ():
            mesh = visual.find("geometry/mesh")
            file = None if mesh is None else mesh_file(mesh.get("filename"), urdf, package_path)
            if file:
                scale = np.array([float(number) for number in mesh.get("scale", "1 1 1").split()])
                found.append(Visual(frame, file, scale, arm.vector(visual, "origin", "xyz"),
                                    arm.rotation_of_rpy(*arm.vector(visual, "origin", "rpy"))))
    return found


def visuals(urdf, base, tip, package_path=()):
    """The Visual of every visual mesh of the chain whose file exists."""
    joints, links = arm.parse(urdf, base, tip)
    names = [base, *(joint.find("child").get("link") for joint in joints)]
    found = named_in(links, names, urdf, package_path)
    if not found and (other := packaged(urdf)):
        links = {link.get("name"): link for link in ElementTree.parse(other).getroot().findall("link")}
        found = named_in(links, names, other)
    return found
