// Tests of the Unity package's own code under Mono, without Unity:
//
//   mcs -langversion:7 -out:tests.exe Runtime/Stream/*.cs Runtime/*.cs Samples~/Live/*.cs Tests~/*.cs
//   mono tests.exe                      parsing, handedness, interpolation, reconnecting, hostile messages
//   mono tests.exe ws://HOST:PORT/…     a run against a hub (`shisei live --demo`)
//
// Ends with "N passed, N failed"; exit code 1 when one failed.
using System;

internal static class Program
{
    private static int Main(string[] arguments)
    {
        if (arguments.Length > 0) HubRun.All(arguments[0]);
        else
        {
            ReaderTests.All();
            SpaceTests.All();
            StateTests.All();
            ClientTests.All();
        }
        Console.WriteLine(Checks.Passed + " passed, " + Checks.Failed + " failed");
        return Checks.Failed == 0 ? 0 : 1;
    }
}
