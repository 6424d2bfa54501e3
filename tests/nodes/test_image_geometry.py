"""``image_geometry`` against the equations of ``sensor_msgs/msg/CameraInfo``."""

import sys
from math import atan, inf, isnan

import numpy as np
import pytest

from drake_twin.nodes.image_geometry import PinholeCameraModel, StereoCameraModel
from drake_twin.nodes.message_classes import message_class

CameraInfo = message_class("sensor_msgs/msg/CameraInfo")


def info(baseline=0.0, **more):
    """A camera of 640 x 480 with f = (400, 500) and its centre at (320, 240)."""
    message = CameraInfo(width=640, height=480, d=[0.1, 0.0, 0.0, 0.0, 0.0], **more)
    message.header.frame_id = "optical"
    message.k[:] = [400, 0, 320, 0, 500, 240, 0, 0, 1]
    message.r[:] = np.eye(3).ravel()
    message.p[:] = [400, 0, 320, -400 * baseline, 0, 500, 240, 0, 0, 0, 1, 0]
    return message


def model_of(message):
    model = PinholeCameraModel()
    model.fromCameraInfo(message)
    return model


def test_points_and_pixels():
    """u = 400 x / z + 320, v = 500 y / z + 240."""
    model = model_of(info())
    assert model.project3dToPixel((1.0, -2.0, 4.0)) == (420.0, -10.0)
    assert model.project3dToPixel((0.0, 0.0, 4.0)) == (model.cx(), model.cy()) == (320.0, 240.0)
    assert all(isnan(number) for number in model.project3dToPixel((1.0, 1.0, 0.0)))
    ray = model.projectPixelTo3dRay((420.0, -10.0))
    np.testing.assert_allclose(ray, np.array([1.0, -2.0, 4.0]) / 21**0.5, rtol=1e-12)


def test_what_a_camera_is():
    model = model_of(info())
    assert (model.fx(), model.fy(), model.tfFrame(), model.fullResolution()) == (400.0, 500.0, "optical", (640, 480))
    assert (model.fovX(), model.fovY()) == (2 * atan(0.8), 2 * atan(0.48))
    assert model.intrinsicMatrix().tolist() == [[400, 0, 320], [0, 500, 240], [0, 0, 1]]
    assert model.distortionCoeffs().shape == (5, 1)
    assert model.rotationMatrix().tolist() == np.eye(3).tolist()
    assert (model.getDeltaU(0.5, 2.0), model.getDeltaV(0.5, 2.0)) == (100.0, 125.0)
    assert (model.getDeltaX(100.0, 2.0), model.getDeltaY(125.0, 2.0), model.getDeltaU(1.0, 0.0)) == (0.5, 0.5, inf)


def test_binning_and_a_region():
    """A pixel of the region is (u - offset) / binning."""
    region = message_class("sensor_msgs/msg/RegionOfInterest")(x_offset=100, y_offset=40, width=400, height=200)
    model = model_of(info(binning_x=2, binning_y=4, roi=region))
    assert model.project3dToPixel((1.0, 2.0, 4.0)) == ((420 - 100) / 2, (490 - 40) / 4)
    assert model.intrinsicMatrix()[0, 2] == (320 - 100) / 2
    assert model.fullIntrinsicMatrix()[0, 2] == model.fullProjectionMatrix()[0, 2] == 320
    assert model_of(info()).raw_roi.width == 640  # a region of zeros is the whole image


def test_two_cameras():
    """The right one is 0.25 m to the right: disparity = 400 * 0.25 / z; rectified ones have one f, here 400."""
    model, messages = StereoCameraModel(), (info(), info(baseline=0.25))
    for message in messages:
        message.p[5] = 400
    model.fromCameraInfo(*messages)
    left, right = model.project3dToPixel((1.0, -2.0, 4.0))
    assert (left, right) == ((420.0, 40.0), (395.0, 40.0))
    np.testing.assert_allclose(model.projectPixelTo3d(left, 25.0), (1.0, -2.0, 4.0), rtol=1e-12)
    assert (model.getZ(25.0), model.getDisparity(4.0)) == (4.0, 25.0)
    assert (model.getZ(0.0), model.getDisparity(0.0)) == (inf, inf)
    assert model.projectPixelTo3d(left, 0.0) == (0.0, 0.0, 0.0)
    assert model.tfFrame() == "optical"


def test_rectification_needs_opencv(monkeypatch):
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(ImportError, match="rectification needs OpenCV: pip install opencv-python-headless"):
        model_of(info()).rectifyPoint((1.0, 2.0))
