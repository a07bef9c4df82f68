using System;
using System.Collections.Generic;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Security.Cryptography;
using System.Text;
using System.Threading;

/// <summary>The least WebSocket server (RFC 6455): sends what it is told to, remembers what it hears.</summary>
internal sealed class TestHub : IDisposable
{
    private readonly TcpListener listener;
    private readonly List<TcpClient> clients = new List<TcpClient>();
    private readonly List<string> heard = new List<string>();
    private volatile bool closed;

    public TestHub(int port = 0)
    {
        listener = new TcpListener(IPAddress.Loopback, port);
        listener.Server.SetSocketOption(SocketOptionLevel.Socket, SocketOptionName.ReuseAddress, true);
        listener.Start();
        Port = ((IPEndPoint)listener.LocalEndpoint).Port;
        new Thread(Accept) { IsBackground = true }.Start();
    }

    public int Port { get; private set; }

    /// <summary>The first line of the newest client's request.</summary>
    public string Asked { get; private set; }

    public int Clients { get { lock (clients) return clients.Count; } }

    public string[] Heard { get { lock (heard) return heard.ToArray(); } }

    public void Send(string text) { Raw(Frame(0x81, Encoding.UTF8.GetBytes(text))); }

    /// <summary>A text in pieces of so many bytes.</summary>
    public void SendInPieces(string text, int size)
    {
        byte[] bytes = Encoding.UTF8.GetBytes(text);
        for (int from = 0; from < bytes.Length; from += size)
        {
            int count = Math.Min(size, bytes.Length - from);
            byte[] piece = new byte[count];
            Array.Copy(bytes, from, piece, 0, count);
            int head = (from == 0 ? 1 : 0) | (from + count == bytes.Length ? 0x80 : 0);
            Raw(Frame((byte)head, piece));
        }
    }

    public void Raw(byte[] bytes)
    {
        lock (clients)
        {
            foreach (TcpClient client in clients)
            {
                try
                {
                    client.GetStream().Write(bytes, 0, bytes.Length);
                }
                catch (IOException)
                {
                    // it has gone
                }
            }
        }
    }

    public void DropAll()
    {
        lock (clients)
        {
            foreach (TcpClient client in clients) client.Close();
            clients.Clear();
        }
    }

    public void Dispose()
    {
        closed = true;
        listener.Stop();
        DropAll();
    }

    private static byte[] Frame(byte head, byte[] payload)
    {
        MemoryStream made = new MemoryStream();
        made.WriteByte(head);
        if (payload.Length < 126) made.WriteByte((byte)payload.Length);
        else
        {
            bool large = payload.Length > 65535;
            made.WriteByte((byte)(large ? 127 : 126));
            for (int k = large ? 7 : 1; k >= 0; k--) made.WriteByte((byte)((long)payload.Length >> (8 * k)));
        }
        made.Write(payload, 0, payload.Length);
        return made.ToArray();
    }

    private void Accept()
    {
        while (!closed)
        {
            try
            {
                TcpClient client = listener.AcceptTcpClient();
                new Thread(() => Serve(client)) { IsBackground = true }.Start();
            }
            catch (SocketException)
            {
                return;
            }
            catch (ObjectDisposedException)
            {
                return;
            }
        }
    }

    private void Serve(TcpClient client)
    {
        try
        {
            Stream stream = client.GetStream();
            string key = "", line;
            Asked = Line(stream);
            while ((line = Line(stream)) != "")
            {
                if (line.StartsWith("Sec-WebSocket-Key:", StringComparison.OrdinalIgnoreCase)) key = line.Substring(18).Trim();
            }
            string accept = Convert.ToBase64String(SHA1.Create().ComputeHash(Encoding.ASCII.GetBytes(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11")));
            byte[] answer = Encoding.ASCII.GetBytes("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: " + accept + "\r\n\r\n");
            stream.Write(answer, 0, answer.Length);
            lock (clients) clients.Add(client);
            while (true)
            {
                int head = stream.ReadByte(), length = stream.ReadByte() & 0x7f;
                if (head < 0 || (head & 15) == 8) return;
                if (length == 126) length = stream.ReadByte() << 8 | stream.ReadByte();
                byte[] mask = Bytes(stream, 4), payload = Bytes(stream, length);
                for (int k = 0; k < length; k++) payload[k] ^= mask[k % 4];
                if ((head & 15) == 1) lock (heard) heard.Add(Encoding.UTF8.GetString(payload));
            }
        }
        catch (Exception)
        {
            // the client has gone; the test sees that from its side
        }
    }

    private static string Line(Stream stream)
    {
        StringBuilder line = new StringBuilder();
        for (int c = stream.ReadByte(); c >= 0 && c != '\n'; c = stream.ReadByte())
        {
            if (c != '\r') line.Append((char)c);
        }
        return line.ToString();
    }

    private static byte[] Bytes(Stream stream, int count)
    {
        byte[] bytes = new byte[count];
        for (int at = 0; at < count;)
        {
            int got = stream.Read(bytes, at, count - at);
            if (got <= 0) throw new EndOfStreamException();
            at += got;
        }
        return bytes;
    }
}
