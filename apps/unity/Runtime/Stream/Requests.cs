using System.Globalization;
using System.Text;

namespace Shisei.Stream
{
    /// <summary>What a client may ask of the hub, as messages.</summary>
    public static class Requests
    {
        /// <summary>Starts or stops the recording.</summary>
        public static string Record(bool on) { return "{\"type\":\"record\",\"on\":" + (on ? "true" : "false") + "}"; }

        /// <summary>Makes the attitude of an inertial body now that of the world's axes.</summary>
        public static string Align(int body) { return "{\"type\":\"align\",\"body\":" + Number(body) + "}"; }

        /// <summary>Sets the heading of a body, degrees from the world's x axis to the left.</summary>
        public static string Heading(int body, double degrees)
        {
            return "{\"type\":\"heading\",\"body\":" + Number(body) + ",\"deg\":" + Number(Axes.IsFinite(degrees) ? degrees : 0) + "}";
        }

        /// <summary>Gives a node another name.</summary>
        public static string Name(string node, string name)
        {
            return "{\"type\":\"name\",\"node\":" + Quoted(node) + ",\"name\":" + Quoted(name) + "}";
        }

        private static string Number(double value) { return value.ToString("R", CultureInfo.InvariantCulture); }

        private static string Quoted(string text)
        {
            StringBuilder made = new StringBuilder("\"");
            foreach (char c in text)
            {
                if (c == '"' || c == '\\') made.Append('\\').Append(c);
                else if (c < ' ') made.Append("\\u").Append(((int)c).ToString("x4", CultureInfo.InvariantCulture));
                else made.Append(c);
            }
            return made.Append('"').ToString();
        }
    }
}
