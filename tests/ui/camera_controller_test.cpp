// The camera's gestures.
#include <QTest>
#include <cmath>

#include "ui/camera_controller.h"

namespace {

using namespace hl;
using hl::ui::CameraController;

bool near(vec3 a, vec3 b, float tolerance = 1e-4f) { return glm::length(a - b) <= tolerance; }

class CameraControllerTest : public QObject {
  Q_OBJECT

  CameraController c_;
  Camera start_;

 private slots:
  void init() {
    c_ = CameraController();
    start_ = Camera();
    start_.position = vec3(0, 1, 5), start_.target = vec3(0, 1, 0);
    c_.set(start_);
    c_.setSceneSize(10);
  }

  void orbitKeepsDistanceAndTarget() {
    c_.orbit(0.7f, 0.3f);
    QVERIFY(near(c_.camera().target, start_.target));
    QVERIFY(std::abs(glm::length(c_.camera().position - c_.camera().target) - 5) < 1e-4f);
    QVERIFY(c_.camera().position.y > 1);
    c_.orbit(-0.7f, -0.3f);
    QVERIFY(near(c_.camera().position, start_.position, 1e-3f));
  }

  void aWholeTurnComesBack() {
    for (int i = 0; i < 8; ++i) c_.orbit(static_cast<float>(M_PI) / 4, 0);
    QVERIFY(near(c_.camera().position, start_.position, 1e-3f));
  }

  void thePolesAreNeverCrossed() {
    for (int i = 0; i < 50; ++i) c_.orbit(0.1f, 0.4f);
    const vec3 back = glm::normalize(c_.camera().position - c_.camera().target);
    QVERIFY(back.y > 0.99f && back.y < 1);
    QVERIFY(std::isfinite(c_.camera().position.x));
  }

  void lookKeepsTheEye() {
    c_.look(0.4f, 0.2f);
    QVERIFY(near(c_.camera().position, start_.position));
    QVERIFY(std::abs(glm::length(c_.camera().target - c_.camera().position) - 5) < 1e-3f);
    QVERIFY(c_.camera().target.y > 1);
  }

  void panMovesBothByTheSame() {
    c_.pan(0.5f, 0.25f);
    QVERIFY(near(c_.camera().position - start_.position, c_.camera().target - start_.target));
    const float height = 2 * 5 * std::tan(start_.verticalFov / 2);
    QVERIFY(near(c_.camera().position - start_.position, vec3(0.5f * height, 0.25f * height, 0), 1e-3f));
  }

  void dollyNeverPassesTheTarget() {
    for (int i = 0; i < 500; ++i) c_.dolly(1);
    QVERIFY(c_.camera().position.z > 0);
    c_.set(start_);
    c_.dolly(1);
    c_.dolly(-1);
    QVERIFY(near(c_.camera().position, start_.position, 1e-3f));
  }

  void flyGoesWhereTheCameraLooks() {
    c_.fly(vec3(0, 0, 1), 1);
    QVERIFY(near(c_.camera().position, start_.position + vec3(0, 0, -c_.flySpeed())));
    QVERIFY(near(c_.camera().target, start_.target + vec3(0, 0, -c_.flySpeed())));
  }

  void focusTurnsToThePoint() {
    c_.focus(vec3(2, 0, -1));
    QVERIFY(near(c_.camera().target, vec3(2, 0, -1)));
    QVERIFY(near(c_.camera().position, start_.position));
    c_.focus(start_.position);  // nowhere to look
    QVERIFY(near(c_.camera().target, vec3(2, 0, -1)));
  }
};

}  // namespace

QTEST_MAIN(CameraControllerTest)
#include "camera_controller_test.moc"
