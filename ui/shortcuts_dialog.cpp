#include "ui/shortcuts_dialog.h"

#include <QAction>
#include <QDialogButtonBox>
#include <QHeaderView>
#include <QMenu>
#include <QMenuBar>
#include <QTreeWidget>
#include <QVBoxLayout>

namespace hl::ui {

ShortcutsDialog::ShortcutsDialog(const QMenuBar& menus, QWidget* parent) : QDialog(parent) {
  setWindowTitle(tr("Keyboard and mouse"));
  auto* column = new QVBoxLayout(this);
  auto* tree = new QTreeWidget(this);
  tree->setColumnCount(2);
  tree->setHeaderLabels({tr("What"), tr("Key or gesture")});
  tree->setSelectionMode(QAbstractItemView::NoSelection);
  tree->setAccessibleName(tr("Keyboard and mouse"));
  const auto section = [&](const QString& name) {
    auto* item = new QTreeWidgetItem(tree, {name});
    QFont bold = item->font(0);
    bold.setBold(true);
    item->setFont(0, bold);
    return item;
  };
  auto* viewport = section(tr("Viewport"));
  const std::pair<QString, QString> gestures[] = {
      {tr("Orbit"), tr("Left drag")},
      {tr("Look round"), tr("Right drag")},
      {tr("Move sideways"), tr("Middle drag, or Shift and left drag")},
      {tr("Nearer, farther"), tr("Wheel")},
      {tr("Fly"), tr("W A S D, Page Up, Page Down")},
      {tr("Flying speed"), tr("Wheel with the right button held")},
      {tr("Focus on a point and orbit round it"), tr("Double click")},
      {tr("Pick a point"), tr("Click")},
      {tr("Reference instead of the picture"), tr("Space, held")},
      {tr("Samples behind a point, and its facts"), tr("Click; Esc hides them")},
      {tr("Enlarge the picture at the pointer"), tr("Ctrl and wheel")},
      {tr("Move an enlarged picture"), tr("Ctrl and left drag, or Ctrl and the arrows")},
      {tr("Move the line of a wipe"), tr("Drag it, or the arrows; with Shift finely")},
      {tr("Inspect a pixel"), tr("Right click")},
      {tr("Draw a region of interest"), tr("Ctrl, Shift and left drag; or R, then drag")},
      {tr("Go to a camera"), tr("1 to 9")},
      {tr("Keep the present camera"), tr("Ctrl+1 to Ctrl+9")},
      {tr("Open a preset, scene, mesh or screenshot"), tr("Drop it on the window")},
  };
  for (const auto& [what, how] : gestures) new QTreeWidgetItem(viewport, {what, how});
  for (const QAction* top : menus.actions()) {
    if (!top->menu()) continue;
    QTreeWidgetItem* group = nullptr;
    QList<QAction*> actions = top->menu()->actions();
    for (qsizetype i = 0; i < actions.size(); ++i)  // those of menus within it too
      if (const QMenu* inner = actions[i]->menu()) actions += inner->actions();
    for (const QAction* a : actions) {
      if (a->shortcut().isEmpty()) continue;
      if (!group) group = section(top->text().remove('&'));
      QStringList keys;
      for (const QKeySequence& k : a->shortcuts()) keys << k.toString(QKeySequence::NativeText);
      new QTreeWidgetItem(group, {a->text().remove('&'), keys.join(tr(" or "))});
    }
  }
  tree->expandAll();
  tree->header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  column->addWidget(tree);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  column->addWidget(buttons);
  resize(620, 640);
}

}  // namespace hl::ui
