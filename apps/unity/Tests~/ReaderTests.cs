using System.Text;
using Shisei.Stream;

/// <summary>The JSON reader.</summary>
internal static class ReaderTests
{
    public static void All()
    {
        // expected: the literals as the compiler reads them
        Number("0", 0);
        Number("-0", 0);
        Number("12.5", 12.5);
        Number("-3e2", -300);
        Number("1.25E-3", 1.25e-3);
        Number("0.30000000000000004", 0.30000000000000004);
        Number("123456789012345678901234567890", 123456789012345678901234567890.0);
        Number("1e400", double.PositiveInfinity);
        Number("1e-500", 0);
        Number("0.1234567890123456789012345678901234567890", 0.1234567890123456789012345678901234567890);
        Checks.That("null is no number", double.IsNaN(Reader("null").Number()));
        Checks.That("text is no number", double.IsNaN(Reader("\"5\"").Number()));
        Checks.That("escapes", Reader("\"a\\\"\\\\\\/\\b\\n\\u624b\\ud83d\\ude00\"").Text(50) == "a\"\\/\b\n手\ud83d\ude00");
        Checks.That("UTF-8", Reader("\"手首\"").Text(50) == "手首");
        Checks.That("long texts are cut", Reader("\"" + new string('x', 5000) + "\"").Text(10) == "xxxxxxxxxx");
        Checks.That("true", Reader("true").True() && !Reader("false").True() && !Reader("1").True());
        Refused("");
        foreach (string text in new[] { "{", "[", "\"", "{\"a\"", "{\"a\":", "{\"a\":1", "{\"a\":1,}", "[1,]", "[1 2]", "{1:2}", "tru", "nul", "-", "1e", "\"\\", "[\"\u0001\"]", "}", "]", ":", ",", "{\"a\":1}}", "1 2" })
        {
            Refused(text);
        }
        Refused("\"\\x\"", true);
        Refused("\"\\u12\"", true);
        Refused(new string('[', 100000));
        Refused("{\"a\":" + new string('[', 17) + new string(']', 17) + "}");
        byte[] half = { (byte)'"', 0xe6, 0x89, (byte)'"' };
        JsonReader reader = new JsonReader();
        reader.Reset(half, half.Length);
        Checks.That("half a character is no end", reader.Text(10) != null);
    }

    private static JsonReader Reader(string text)
    {
        byte[] bytes = Encoding.UTF8.GetBytes(text);
        JsonReader reader = new JsonReader();
        reader.Reset(bytes, bytes.Length);
        return reader;
    }

    private static void Number(string text, double expected)
    {
        double got = Reader(text).Number();
        double within = double.IsInfinity(expected) ? 0 : System.Math.Abs(expected) * 3e-16;
        Checks.That("number " + text, got == expected || System.Math.Abs(got - expected) <= within, got.ToString("R"));
    }

    private static void Refused(string text, bool asText = false)
    {
        bool refused = false;
        try
        {
            JsonReader reader = Reader(text);
            if (asText) reader.Text(10);
            else reader.Skip();
            reader.Finish();
        }
        catch (JsonException)
        {
            refused = true;
        }
        Checks.That("refused: " + (text.Length > 40 ? text.Substring(0, 40) + "…" : text), refused);
    }
}
