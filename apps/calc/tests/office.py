"""A real LibreOffice, headless, with shisei.oxt installed in a profile of its own.

Used as `with Office(oxt) as office:`; needs the Python that has the uno module (python3-uno).
"""
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time

import uno
from com.sun.star.beans import PropertyValue
from com.sun.star.connection import NoConnectException


def pv(name, value):
    p = PropertyValue()
    p.Name, p.Value = name, value
    return p


class Office:
    def __init__(self, oxt, lang=None):
        self.dir = tempfile.mkdtemp(prefix="shisei-calc-")
        os.chmod(self.dir, 0o777)
        self.profile = "file://" + self.dir + "/profile"
        shutil.copy(oxt, self.dir + "/shisei.oxt")
        os.chmod(self.dir + "/shisei.oxt", 0o644)
        self.lang = lang

    def unprivileged(self, *command):
        """unopkg refuses root, so root hands over to nobody."""
        if os.getuid() == 0:
            command = ("setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups", "env", "HOME=" + self.dir,
                       *command)
        return command

    def __enter__(self):
        done = subprocess.run(self.unprivileged("unopkg", "add", "--force", self.dir + "/shisei.oxt",
                                                "-env:UserInstallation=" + self.profile), capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        with socket.socket() as free:  # a pipe's name holds its user, who is not ours
            free.bind(("127.0.0.1", 0))
            address = "socket,host=127.0.0.1,port=%d;urp;" % free.getsockname()[1]
        self.process = subprocess.Popen(
            self.unprivileged("soffice", "-env:UserInstallation=" + self.profile, "--headless", "--norestore", "--nologo",
                              "--accept=" + address),
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        local = uno.getComponentContext()
        resolver = local.ServiceManager.createInstanceWithContext("com.sun.star.bridge.UnoUrlResolver", local)
        for _ in range(600):
            try:
                self.ctx = resolver.resolve("uno:" + address + "StarOffice.ComponentContext")
                break
            except NoConnectException:
                time.sleep(0.1)
        else:
            raise RuntimeError("LibreOffice did not start")
        self.desktop = self.make("com.sun.star.frame.Desktop")
        self.configure("/org.openoffice.Office.Calc/Formula/Load", OOXMLRecalcMode=0, ODFRecalcMode=0)
        return self

    def __exit__(self, *_):
        try:
            self.desktop.terminate()
        except Exception:
            pass
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            pass
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        shutil.rmtree(self.dir, ignore_errors=True)

    def make(self, service, *args):
        manager = self.ctx.ServiceManager
        if args:
            return manager.createInstanceWithArgumentsAndContext(service, args, self.ctx)
        return manager.createInstanceWithContext(service, self.ctx)

    def configure(self, path, **values):
        provider = self.make("com.sun.star.configuration.ConfigurationProvider")
        update = provider.createInstanceWithArguments("com.sun.star.configuration.ConfigurationUpdateAccess",
                                                      (pv("nodepath", path),))
        for name, value in values.items():
            update.setPropertyValue(name, value)
        update.commitChanges()

    def version(self):
        provider = self.make("com.sun.star.configuration.ConfigurationProvider")
        access = provider.createInstanceWithArguments("com.sun.star.configuration.ConfigurationAccess",
                                                      (pv("nodepath", "/org.openoffice.Setup/Product"),))
        return access.getPropertyValue("ooSetupVersionAboutBox")

    def new(self):
        return self.desktop.loadComponentFromURL("private:factory/scalc", "_blank", 0, (pv("Hidden", True),))

    def open(self, path, **properties):
        hidden = (pv("Hidden", True), *[pv(k, v) for k, v in properties.items()])
        return self.desktop.loadComponentFromURL("file://" + os.path.abspath(path), "_blank", 0, hidden)

    def function_description(self, name):
        for i, d in enumerate(self.make("com.sun.star.sheet.FunctionDescriptions").ElementNames):
            if d.lower() == name.lower():
                return {p.Name: p.Value for p in
                        self.make("com.sun.star.sheet.FunctionDescriptions").getByName(d)}
        return None
