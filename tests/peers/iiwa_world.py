"""Drake's simulated iiwa on LCM, and the target and the obstacles around it."""
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
from pydrake.lcm import DrakeLcm
from pydrake.manipulation import BuildIiwaControl, IiwaDriver
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.lcm import LcmInterfaceSystem

ROOT = Path(__file__).resolve().parents[2]
URDF = ROOT / "urdf/iiwa14.urdf"
HOME_RAD = [0, 0.6, 0, -1.2, 0, 0.9, 0]
STEP_S = 0.001
LINK_KG, LINK_KGM2 = 3.5, 0.03  # roughly a seventh of the arm each


def urdf_with_masses():
    """The arm with the masses that Drake needs; Sidestep uses no dynamics."""
    robot = xml.parse(URDF).getroot()
    for link in robot.iter("link"):
        heavy = link.find("collision") is not None
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "mass", value=str(LINK_KG if heavy else 0.1))
        moment = str(LINK_KGM2 if heavy else 1e-4)
        xml.SubElement(inertial, "inertia", ixx=moment, iyy=moment, izz=moment, ixy="0", ixz="0", iyz="0")
    return xml.tostring(robot, encoding="unicode")


def add_arm(plant):
    arm = Parser(plant).AddModelsFromString(urdf_with_masses(), "urdf")[0]
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    for index in plant.GetJointIndices(arm):
        joint = plant.get_joint(index)
        if joint.num_velocities():
            plant.AddJointActuator(joint.name(), joint)
    plant.Finalize()
    return arm


class Iiwa:
    """A simulated arm with Drake's position control, which sends IIWA_STATUS and receives IIWA_COMMAND."""

    def __init__(self, lcm_url):
        builder = DiagramBuilder()
        self.plant, scene = AddMultibodyPlantSceneGraph(builder, STEP_S)
        arm = add_arm(self.plant)
        links = [self.plant.get_body(index) for index in self.plant.GetBodyIndices(arm)]
        own = GeometrySet([g for link in links for g in self.plant.GetCollisionGeometriesForBody(link)])
        scene.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(own))
        self._controlled = MultibodyPlant(STEP_S)
        add_arm(self._controlled)
        network = DrakeLcm(lcm_url)
        builder.AddSystem(LcmInterfaceSystem(network))
        BuildIiwaControl(builder=builder, lcm=network, plant=self.plant, iiwa_instance=arm,
                         controller_plant=self._controlled, driver_config=IiwaDriver(control_mode="position_only"))
        self.scene = scene
        self.simulator = Simulator(builder.Build())
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.plant.SetPositions(self.context, arm, HOME_RAD)
        self.simulator.set_target_realtime_rate(1.0)
        self.simulator.Initialize()

    def advance(self, duration_s):
        self.simulator.AdvanceTo(self.now_s() + duration_s)

    def now_s(self):
        return self.simulator.get_context().get_time()

    def flange_m(self):
        return self.plant.GetFrameByName("flange").CalcPoseInWorld(self.context).translation()

    def clearance_m(self, centre_m, radius_m):
        """From a sphere to the arm's collision geometry, measured by Drake."""
        context = self.scene.GetMyContextFromRoot(self.simulator.get_context())
        query = self.scene.get_query_output_port().Eval(context)
        return min(hit.distance for hit in query.ComputeSignedDistanceToPoint(centre_m)) - radius_m

    def speed_limits_radps(self):
        return self.plant.GetVelocityUpperLimits()


class Oscillation:
    """A point that oscillates about a centre, each axis with an amplitude and a period; at rest at time 0."""

    def __init__(self, centre_m, amplitude_m, period_s):
        self.centre_m, self.amplitude_m = np.array(centre_m), np.array(amplitude_m)
        self.rate_radps = 2 * np.pi / np.array(period_s, float)

    def at(self, time_s):
        """Position and velocity."""
        phase = self.rate_radps * time_s
        return self.centre_m + self.amplitude_m * np.cos(phase), -self.amplitude_m * self.rate_radps * np.sin(phase)


TARGET = Oscillation([0.55, 0, 0.5], [0.08, 0.25, 0.1], [11, 8, 6])
OBSTACLES = [  # radius_m and the motion of the centre
    (0.08, Oscillation([0.5, 0, 0.8], [0, 0.9, 0.1], 9)),
    (0.07, Oscillation([0.75, 0, 0.4], [0.1, 0.8, 0.1], 11)),
    (0.08, Oscillation([0.4, 0.4, 0.7], [0.9, 0, 0.1], 13)),
]
