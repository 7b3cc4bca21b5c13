# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the node share: messages in, messages out, and waiting for them."""
import hashlib
import io
import os
import threading
import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, WrenchStamped
from polyscalpel.msg import ContactForces, CutEvent, StepStatus
from polyscalpel.srv import Cut, Step
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import Marker, MarkerArray

HERE = os.path.dirname(os.path.abspath(__file__))
PATIENCE_S = 120  # No .test file calls its node `required`: where one ends early, rostest finds no result and calls that success.


def serialised(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def digest(messages):
    """One digest of all messages, bit for bit but for the sequence number that ROS gives them."""
    sha = hashlib.sha256()
    for message in messages:
        if hasattr(message, 'header'):
            message.header.seq = 0
        sha.update(serialised(message))
    return sha.hexdigest()


def shapes(marker_array):
    """What a mesh message shows, without stamps and deletions."""
    result = []
    for marker in marker_array.markers:
        if marker.action == Marker.ADD:
            marker.header.stamp = rospy.Time()
            marker.header.seq = 0
            result.append((marker.ns, marker.id, serialised(marker)))
    return sorted(result)


def namespaces(marker_array):
    return {marker.ns for marker in marker_array.markers if marker.action == Marker.ADD}


def wait_until(condition, what):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError('waited in vain for ' + what)
        time.sleep(0.01)


class Listener:
    """Keeps everything that the node publishes, in order; `namespace` is the node's, with a / at its end."""

    def __init__(self, tools=(), namespace=''):
        self.lock = threading.Lock()
        self.mesh, self.status, self.cuts, self.contacts, self.diagnostics = [], [], [], [], []
        self.wrenches = {tool: [] for tool in tools}
        self.subscribers = [
            rospy.Subscriber(namespace + 'mesh', MarkerArray, self.mesh.append, queue_size=None),
            rospy.Subscriber(namespace + 'status', StepStatus, self.status.append, queue_size=None),
            rospy.Subscriber(namespace + 'cut_events', CutEvent, self.cuts.append, queue_size=None),
            rospy.Subscriber(namespace + 'contacts', ContactForces, self.contacts.append, queue_size=None),
            rospy.Subscriber('/diagnostics', DiagnosticArray, self.diagnostics.append, queue_size=None),
        ]
        for tool, messages in self.wrenches.items():
            self.subscribers.append(
                rospy.Subscriber(namespace + tool + '/body/measured_cf', WrenchStamped, messages.append, queue_size=None))
        wait_until(lambda: all(s.get_num_connections() > 0 for s in self.subscribers), 'the topics of the node')
        wait_until(lambda: self.mesh and self.status, 'the latched mesh and status')

    def clear(self):
        for messages in [self.mesh, self.status, self.cuts, self.contacts, self.diagnostics, *self.wrenches.values()]:
            del messages[:]

    def tool(self, name):
        """The newest status of a tool."""
        return next(tool for tool in self.status[-1].tools if tool.name == name)


class Services:
    def __init__(self, namespace=''):
        for name, kind in (('reset', Trigger), ('cut', Cut), ('set_paused', SetBool), ('step', Step)):
            rospy.wait_for_service(namespace + name, PATIENCE_S)
            setattr(self, name, rospy.ServiceProxy(namespace + name, kind))


def pose(stamp_s, position, quaternion=(0, 0, 0, 1), frame='world'):
    message = PoseStamped()
    message.header.stamp = rospy.Time.from_sec(stamp_s)
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y, message.pose.position.z = position
    (message.pose.orientation.x, message.pose.orientation.y, message.pose.orientation.z,
     message.pose.orientation.w) = quaternion
    return message


class Hand:
    """Sends poses for tools and waits until the node has taken them."""

    def __init__(self, tools):
        self.publishers = {tool: rospy.Publisher(tool + '/measured_cp', PoseStamped, queue_size=10000) for tool in tools}
        wait_until(lambda: all(p.get_num_connections() > 0 for p in self.publishers.values()), 'the node to listen')

    def send(self, tool, message):
        self.publishers[tool].publish(message)


def stroke(start_s, start, end, duration_s=1.0, rate_hz=50):
    """Poses on a line, the last one exactly at start_s + duration_s."""
    count = int(round(duration_s * rate_hz))
    return [pose(start_s + i / rate_hz, [a + (b - a) * i / count for a, b in zip(start, end)]) for i in range(count + 1)]
